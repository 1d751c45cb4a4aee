// One texel of so many of the volume that was selected last, the index clamped to the grid.
#import slot "volumes"

fn volume_texel(index: vec3i, dims: vec3f) -> f32 {
    return volumes_load(clamp(index, vec3i(0), vec3i(dims) - 1));
}
