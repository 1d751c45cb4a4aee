// The background: from one colour at the bottom to another at the top.

struct Params {
    /// Linear premultiplied colour at the bottom. @default 0.02 0.02 0.03 1 @range 0 1 @color
    bottom: vec4f,
    /// Linear premultiplied colour at the top. @default 0.20 0.24 0.30 1 @range 0 1 @color
    top: vec4f,
}

// `place` is in the view plane: -1..1 over the height, y up.
fn pattern_color(place: vec2f) -> vec4f {
    return mix(params.bottom, params.top, clamp(place.y * 0.5 + 0.5, 0.0, 1.0));
}
