// The scalar at a point: trilinear between voxel centres.
// @order 2
#import "lib/volume.wgsl"

fn reconstruct_scalar(position: vec3f) -> f32 {
    return volume_linear(position);
}
