// A picture over a rectangle of the window.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var picture_sampler: sampler;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) place: vec2f,
}

@vertex
fn blit_corner(@builtin(vertex_index) index: u32) -> Corner {
    // One triangle over the whole rectangle.
    let corner = 2.0 * vec2f(f32(index & 1u), f32(index >> 1u));
    return Corner(vec4f(2.0 * corner - 1.0, 0.0, 1.0), vec2f(corner.x, 1.0 - corner.y));
}

@fragment
fn blit_codes(corner: Corner) -> @location(0) vec4f {
    return textureSampleLevel(picture, picture_sampler, corner.place, 0.0);
}

// For windows that encode by themselves.
@fragment
fn blit_linear(corner: Corner) -> @location(0) vec4f {
    let codes = textureSampleLevel(picture, picture_sampler, corner.place, 0.0);
    let low = codes.rgb / 12.92;
    let high = pow((codes.rgb + 0.055) / 1.055, vec3f(2.4));
    return vec4f(select(high, low, codes.rgb <= vec3f(0.04045)), codes.a);
}
