// What is known of a brick? Whether it may be seen, how many steps a segment may take here, and how far around that holds.
#import "lib/brick_look.wgsl"
#import "lib/bricks.wgsl"
#import "lib/nearest_sampler.wgsl"

@group(1) @binding(34) var stride_map: texture_2d<f32>;

// Long segments as well: fewer samples are what it is for.
fn look_least() -> u32 {
    return 2u;
}

fn look_at(brick: vec3i) -> BrickLook {
    let number = u32(textureSampleLevel(stride_map, nearest_sampler, bricks_in_map(brick), 0.0).x);
    let radius = i32(1u << ((number >> 12u) & 7u)) - 1;
    let power = (number >> 8u) & 7u;
    return BrickLook(power < 7u, brick - radius, brick + radius + 1, power);
}
