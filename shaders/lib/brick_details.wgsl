// The largest first and second derivative of each brick along any direction, in data units per world unit.
#import "lib/bricks.wgsl"
#import "lib/nearest_sampler.wgsl"

@group(1) @binding(33) var brick_details: texture_3d<f32>;

fn brick_detail(brick: vec3i) -> vec2f {
    let place = (vec3f(brick) + 0.5) / vec3f(bricks.dims);
    return textureSampleLevel(brick_details, nearest_sampler, place, 0.0).xy;
}
