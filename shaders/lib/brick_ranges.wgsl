// The least and the largest scalar of each brick.
#import "lib/bricks.wgsl"
#import "lib/nearest_sampler.wgsl"

@group(1) @binding(31) var brick_ranges: texture_3d<f32>;

fn brick_range(brick: vec3i) -> vec2f {
    let place = (vec3f(brick) + 0.5) / vec3f(bricks.dims);
    return textureSampleLevel(brick_ranges, nearest_sampler, place, 0.0).xy;
}
