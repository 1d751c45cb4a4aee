// One texel of so many, the index clamped to the grid: loaded, for devices that read a texture through one sampler only, and
// for several volumes. A load is checked against the texture's size each time.
#import slot "volumes"

fn volume_texel(index: vec3i, dims: vec3f) -> f32 {
    return volumes_load(clamp(index, vec3i(0), vec3i(dims) - 1));
}
