// How gradients are stored: direction and the root of the length in 8 bits each, a quarter of the memory of floats.

@group(3) @binding(9) var gradient_out: texture_storage_3d<rgba8snorm, write>;

// Of a gradient per voxel, as a share of the data's range, and of the voxel's own texel; its length is at most the root of three. The root
// gives weak gradients more of the codes.
fn gradient_encode(per_index: vec3f, texel: f32) -> vec4f {
    let magnitude = length(per_index);
    return vec4f(per_index / max(magnitude, 1.0e-12), sqrt(magnitude / sqrt(3.0)));
}

fn gradient_decode(stored: vec4f) -> vec3f {
    let direction = stored.xyz / max(length(stored.xyz), 1.0e-6);
    return direction * (stored.w * stored.w * sqrt(3.0));
}
