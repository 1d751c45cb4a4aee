// Squares of four pixels a side whose rays may see something, in a list that a dispatch goes over.

// Pixels along a block's side.
const ACTIVE_BLOCKS_SIDE: u32 = 4u;
// Blocks of a workgroup, and workgroups in a row at most: devices have a limit for each axis.
const ACTIVE_BLOCKS_GROUP: u32 = 4u;
const ACTIVE_BLOCKS_ROW: u32 = 32768u;

// Workgroups that so many blocks take.
fn active_blocks_groups(count: u32) -> u32 {
    return (count + ACTIVE_BLOCKS_GROUP - 1u) / ACTIVE_BLOCKS_GROUP;
}

// Of 64 blocks in a square the one whose turn it is: those of each quarter one after the other, and so within it (Morton 1966).
fn active_blocks_turn(number: u32) -> vec2u {
    let x = (number & 1u) | ((number >> 1u) & 2u) | ((number >> 2u) & 4u);
    let y = ((number >> 1u) & 1u) | ((number >> 2u) & 2u) | ((number >> 3u) & 4u);
    return vec2u(x, y);
}

// A block of pixels from its place in the list, and back: x in the lower 16 bits, y in the upper ones.
fn active_blocks_packed(block: vec2u) -> u32 {
    return block.x | (block.y << 16u);
}

fn active_blocks_unpacked(packed: u32) -> vec2u {
    return vec2u(packed & 0xffffu, packed >> 16u);
}
