// The volume's texels.

@group(1) @binding(1) var volume_texture: texture_3d<f32>;
@group(1) @binding(2) var linear_sampler: sampler;
