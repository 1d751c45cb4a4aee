// Whole steps from the entry; the last segment ends at the exit.
#import "lib/step.wgsl"

// World distance from the entry to the end of segment number `index`.
fn traverse_segment_end(ray: Ray, index: u32) -> f32 {
    return min(f32(index + 1u) * step_world(), ray.far - ray.near);
}
