// Which volume is read: the only one, from the texture of its gradients, whose fourth channel has its scalars: who asks for
// both at a place reads it once.
#import "lib/gradient_texture.wgsl"
#import "lib/only_volume.wgsl"
#import "lib/volume_texture.wgsl"

// How many voxels wide the samples are that are read at a position.
fn volumes_grain(position: vec3f) -> f32 {
    return 1.0;
}

// The texel at a position, by the device's filter.
fn volumes_filter(position: vec3f) -> f32 {
    return textureSampleLevel(gradient_volume, linear_sampler, position, 0.0).w;
}

// The texel of a voxel.
fn volumes_load(index: vec3i) -> f32 {
    return textureLoad(gradient_volume, index, 0).w;
}
