// One texel of so many, the index clamped to the grid: loaded, for devices that read a texture through one sampler only. A load is
// checked against the texture's size each time.
#import "lib/volume_texture.wgsl"

fn volume_texel(index: vec3i, dims: vec3f) -> f32 {
    return textureLoad(volume_texture, clamp(index, vec3i(0), vec3i(dims) - 1), 0).x;
}
