// The gradient at a point: that of the trilinear field itself, from the eight voxels around. It jumps from cell to cell:
// the facets of the field as it is. Zero across the clamped outer half voxel of the box.
#import "lib/cell.wgsl"

// World-space gradient, data units per world unit.
fn gradient_at(position: vec3f) -> vec3f {
    let place = position * volume.dims - 0.5;
    let low = floor(place);
    let per_index = cell_gradient(cell_values(vec3i(low), 0.0), place - low);
    return volume.world_from_index_gradient * per_index;
}
