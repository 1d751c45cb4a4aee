// The step of walks along rays.
#import "lib/volume.wgsl"

struct Params {
    /// Length of a segment, in voxels of the smallest spacing. @default 1.0 @range 0.01 64.0 @unit voxel
    step: f32,
}

// World length of a step.
fn step_world() -> f32 {
    return params.step * volume.voxel;
}
