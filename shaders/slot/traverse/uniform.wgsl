// Where the next segment ends: whole steps from the entry; the last segment ends at the exit.
#import "lib/volume.wgsl"

struct Params {
    /// Length of a segment, in voxels of the smallest spacing. @default 1.0 @range 0.01 64.0 @unit voxel
    step: f32,
}

// World distance from the entry to the end of segment number `index`.
fn traverse_segment_end(ray: Ray, index: u32) -> f32 {
    return min(f32(index + 1u) * (params.step * volume.voxel), ray.far - ray.near);
}
