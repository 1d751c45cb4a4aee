// Which pixels does a compute dispatch go over? Those that a scout has found something for, and no others.
#import "lib/active_blocks.wgsl"
#import "lib/lane.wgsl"

struct ActiveBlocks {
    workgroups: vec3u,
    count: u32,
    blocks: array<u32>,
}

@group(1) @binding(37) var<storage, read> active_blocks: ActiveBlocks;

// Four blocks of the list for each workgroup.
fn pixels_at(group: vec3u, lane: u32) -> vec2u {
    let number = group.y * active_blocks.workgroups.x + group.x;
    let place = ACTIVE_BLOCKS_GROUP * number + lane_square(lane);
    if place >= active_blocks.count {
        return vec2u(0xffffffffu);
    }
    return ACTIVE_BLOCKS_SIDE * active_blocks_unpacked(active_blocks.blocks[place]) + lane_pixel(lane);
}
