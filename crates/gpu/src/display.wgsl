// Linear colours as screens want them: premultiplied over black, sRGB codes in eight bits.

@group(0) @binding(0) var linear_colors: texture_2d<f32>;

fn srgb_from_linear(linear: vec3f) -> vec3f {
    let light = clamp(linear, vec3f(0.0), vec3f(1.0));
    let low = 12.92 * light;
    let high = 1.055 * pow(light, vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, light <= vec3f(0.0031308));
}

@vertex
fn display_corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle over the whole picture.
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    return vec4f(4.0 * corner - 1.0, 0.0, 1.0);
}

@fragment
fn display_pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let color = textureLoad(linear_colors, vec2i(position.xy), 0);
    return vec4f(srgb_from_linear(color.rgb), 1.0);
}
