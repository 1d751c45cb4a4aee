// How gradients are stored: as they are, in single floats, and beside them the voxel's own texel. Where light is looked up at
// the same places as scalars, both are one read. Four times the memory of floats alone.

@group(3) @binding(9) var gradient_out: texture_storage_3d<rgba32float, write>;

// Of a gradient per voxel, as a share of the data's range, and of the voxel's own texel.
fn gradient_encode(per_index: vec3f, texel: f32) -> vec4f {
    return vec4f(per_index, texel);
}

fn gradient_decode(stored: vec4f) -> vec3f {
    return stored.xyz;
}
