// Which volume is read: that of two which was selected last.
#import "lib/volume_texture.wgsl"
#import "lib/volumes.wgsl"

@group(1) @binding(41) var volume_2_texture: texture_3d<f32>;

const VOLUMES_COUNT: u32 = 2u;

// The texel at a position, by the device's filter.
fn volumes_filter(position: vec3f) -> f32 {
    if volumes_chosen == 1u {
        return textureSampleLevel(volume_2_texture, linear_sampler, position, 0.0).x;
    }
    return textureSampleLevel(volume_texture, linear_sampler, position, 0.0).x;
}

// The texel of a voxel.
fn volumes_load(index: vec3i) -> f32 {
    if volumes_chosen == 1u {
        return textureLoad(volume_2_texture, index, 0).x;
    }
    return textureLoad(volume_texture, index, 0).x;
}
