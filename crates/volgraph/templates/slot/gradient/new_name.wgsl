// The gradient at a point: central differences of the reconstructed field over a width that can be set.
//
// A gradient is asked for by lights, at a position in texture coordinates, and gives data units per world unit.
#import "lib/volume.wgsl"
#import slot "reconstruct"

struct Params {
    /// Distance of the two samples of a difference: wide ones are smooth. @default 1 @range 0.1 16 @unit voxel
    width: f32,
}

fn new_name_difference(position: vec3f, axis: vec3f) -> f32 {
    let aside = 0.5 * params.width * axis / volume.dims;
    return (reconstruct_scalar(position + aside) - reconstruct_scalar(position - aside)) / params.width;
}

// Differences per voxel along the index axes; the matrix has spacing and orientation in it.
fn gradient_at(position: vec3f) -> vec3f {
    let per_index = vec3f(
        new_name_difference(position, vec3f(1.0, 0.0, 0.0)),
        new_name_difference(position, vec3f(0.0, 1.0, 0.0)),
        new_name_difference(position, vec3f(0.0, 0.0, 1.0)),
    );
    return volume.world_from_index_gradient * per_index;
}
