// The gradient at a point: that of the cubic B-spline over the voxels, smooth from cell to cell; the exact one of the
// field that `reconstruct` `tricubic` makes. Voxels beside the grid repeat those at its edge. 24 trilinear samples.
#import "lib/bspline.wgsl"

// World-space gradient, data units per world unit.
fn gradient_at(position: vec3f) -> vec3f {
    let place = bspline_place(position);
    let value = bspline_value(place);
    let slope = bspline_derivative(place);
    let per_index = vec3f(
        bspline_sum(slope, value, value),
        bspline_sum(value, slope, value),
        bspline_sum(value, value, slope),
    );
    return volume.world_from_index_gradient * per_index;
}
