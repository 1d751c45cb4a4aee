// Which pixels does a compute dispatch go over? Those that a scout has found something for, and no others.
#import "lib/active_blocks.wgsl"
#import "lib/lane.wgsl"

struct ActiveBlocks {
    workgroups: vec3u,
    count: u32,
    blocks: array<u32>,
}

@group(1) @binding(37) var<storage, read> active_blocks: ActiveBlocks;

// A workgroup has a block of each quarter of the list, in two of them counted from the end. Processors hand workgroups out in as
// many equal parts as they have threads, and neighbours in the picture are much the same work.
fn pixels_at(group: vec3u, lane: u32) -> vec2u {
    let count = active_blocks.count;
    let groups = active_blocks_groups(count);
    let number = group.y * active_blocks.workgroups.x + group.x;
    let quarter = lane_square(lane);
    let place = quarter * groups + select(number, groups - 1u - number, (quarter & 1u) == 1u);
    if number >= groups || place >= count {
        return vec2u(0xffffffffu);
    }
    return ACTIVE_BLOCKS_SIDE * active_blocks_unpacked(active_blocks.blocks[place]) + lane_pixel(lane);
}
