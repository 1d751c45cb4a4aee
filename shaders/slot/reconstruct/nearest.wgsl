// The scalar at a point: that of the nearest voxel.
// @order 1
#import "lib/volume.wgsl"

fn reconstruct_scalar(position: vec3f) -> f32 {
    return volume_nearest(position);
}
