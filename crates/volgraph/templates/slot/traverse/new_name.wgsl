// Where the next segment ends: each is longer than the one before, so that what lies deep costs less.
//
// A traversal gives the world distance from the ray's entry to the end of segment number `index`, from 0. It must grow
// with the index, and must not pass the exit: the ray is walked until a segment ends there.
#import "lib/step.wgsl"

struct Params {
    /// How much longer the segments are after a hundred voxels. @default 1 @range 0 10
    growth: f32,
}

// The first segment is one `step` of lib/step.wgsl long, in voxels of the smallest spacing.
// As the sum of all segments before, and never added up: the error stays one rounding.
fn traverse_segment_end(ray: Ray, index: u32) -> f32 {
    let even = f32(index + 1u) * params.step;
    let end = even * (1.0 + 0.005 * params.growth * even);
    return min(end * volume.voxel, ray.far - ray.near);
}
