// The clip volume's texel at a point, trilinear: by the device's own filter.
#import "lib/clip_volume_texture.wgsl"

fn clip_volume_filter(position: vec3f) -> f32 {
    return textureSampleLevel(clip_volume_texture, linear_sampler, position, 0.0).x;
}
