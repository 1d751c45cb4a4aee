// Which legend is drawn into the picture? None.

// Linear premultiplied colour over a pixel.
fn legend_color(pixel: vec2i) -> vec4f {
    return vec4f(0.0);
}
