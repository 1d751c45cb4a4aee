// The gradient at a point: central differences of the reconstructed field, one voxel to each side, of those that are read there.
#import "lib/volume.wgsl"
#import slot "reconstruct"

// World-space gradient, data units per world unit.
fn gradient_at(position: vec3f) -> vec3f {
    let grain = volumes_grain(position);
    let h = grain / volume.dims;
    let per_index = 0.5 / grain * vec3f(
        reconstruct_scalar(position + vec3f(h.x, 0.0, 0.0)) - reconstruct_scalar(position - vec3f(h.x, 0.0, 0.0)),
        reconstruct_scalar(position + vec3f(0.0, h.y, 0.0)) - reconstruct_scalar(position - vec3f(0.0, h.y, 0.0)),
        reconstruct_scalar(position + vec3f(0.0, 0.0, h.z)) - reconstruct_scalar(position - vec3f(0.0, 0.0, h.z)),
    );
    return volume.world_from_index_gradient * per_index;
}
