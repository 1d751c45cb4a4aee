// How gradients are stored: as they are, in half floats.

@group(3) @binding(9) var gradient_out: texture_storage_3d<rgba16float, write>;

// Of a gradient per voxel, as a share of the data's range, and of the voxel's own texel.
fn gradient_encode(per_index: vec3f, texel: f32) -> vec4f {
    return vec4f(per_index, 0.0);
}

fn gradient_decode(stored: vec4f) -> vec3f {
    return stored.xyz;
}
