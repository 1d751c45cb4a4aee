// What is known of a brick? Whether it can raise the largest scalar that the ray has met; of those around it nothing.
#import "lib/brick_look.wgsl"
#import "lib/brick_ranges.wgsl"
#import "lib/extremum.wgsl"

// So many segments are walked at least between two looks.
fn look_least() -> u32 {
    return 8u;
}

fn look_at(brick: vec3i) -> BrickLook {
    return BrickLook(brick_range(brick).y > extremum_reached, brick, brick + 1, 0u);
}
