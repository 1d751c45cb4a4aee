// One texel of so many, the index clamped to the grid: by a sampler, which clamps on its own. At a texel's centre nothing is rounded.
#import "lib/nearest_sampler.wgsl"
#import "lib/volume_texture.wgsl"

fn volume_texel(index: vec3i, dims: vec3f) -> f32 {
    return textureSampleLevel(volume_texture, nearest_sampler, (vec3f(index) + 0.5) / dims, 0.0).x;
}
