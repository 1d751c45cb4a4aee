// The scalar at a point: of the cubic B-spline over the voxels. It smooths: noise and steps of 8 bits go, and so does
// detail of two or three voxels; it does not pass through the voxels' own values. Voxels beside the grid repeat those at
// its edge. Eight trilinear samples.
// @order 2
#import "lib/bspline.wgsl"

fn reconstruct_scalar(position: vec3f) -> f32 {
    let value = bspline_value(bspline_place(position));
    return bspline_sum(value, value, value);
}
