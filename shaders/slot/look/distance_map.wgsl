// What is known of a brick? Whether it may be seen, and how far the next one is of the other kind.
#import "lib/brick_look.wgsl"
#import "lib/bricks.wgsl"
#import "lib/nearest_sampler.wgsl"

@group(1) @binding(32) var distance_map: texture_2d<f32>;

// So many segments are walked at least between two looks.
fn look_least() -> u32 {
    return 8u;
}

fn look_at(brick: vec3i) -> BrickLook {
    let number = u32(textureSampleLevel(distance_map, nearest_sampler, bricks_in_map(brick), 0.0).x) >> 12u;
    // Less than so many bricks away to each side, all bricks are alike.
    let away = i32(number & 0x7ffu);
    return BrickLook((number & 0x800u) != 0u, brick - (away - 1), brick + away, 0u);
}
