// The picture that lies behind the volume.

@group(0) @binding(2) var behind: texture_2d<f32>;
