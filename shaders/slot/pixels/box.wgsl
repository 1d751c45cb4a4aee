// Which pixels does a compute dispatch go over? The rectangle around the proxy geometry.
#import "lib/lane.wgsl"
#import "lib/proxy.wgsl"

fn pixels_at(group: vec3u, lane: u32) -> vec2u {
    let square = lane_square(lane);
    return tile.first + 8u * group.xy + 4u * vec2u(square & 1u, square >> 1u) + lane_pixel(lane);
}
