// The clip volume's texels.
#import "lib/volume_texture.wgsl"

@group(1) @binding(13) var clip_volume_texture: texture_3d<f32>;
