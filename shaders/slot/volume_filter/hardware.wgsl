// The texel at a point, trilinear: by the device's own filter.
#import "lib/volume_texture.wgsl"

fn volume_filter(position: vec3f) -> f32 {
    return textureSampleLevel(volume_texture, linear_sampler, position, 0.0).x;
}
