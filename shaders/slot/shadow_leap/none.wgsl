// Where does a light's ray go on? With the next segment.
#import "lib/ray.wgsl"

// So many segments are walked between two looks.
fn shadow_leap_least() -> u32 {
    return 0xffffu;
}

fn shadow_leap_from(ray: Ray, index: u32, step: f32) -> u32 {
    return index;
}
