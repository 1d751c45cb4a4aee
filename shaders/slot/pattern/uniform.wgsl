// The background: one colour.

struct Params {
    /// Linear premultiplied red, green, blue, alpha. @default 0 0 0 1 @range 0 1 @color
    color: vec4f,
}

// `place` is in the view plane: -1..1 over the height, y up.
fn pattern_color(place: vec2f) -> vec4f {
    return params.color;
}
