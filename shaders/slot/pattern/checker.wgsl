// The background: squares of two colours, attached to the view.

struct Params {
    /// Linear premultiplied colour of one half of the squares. @default 0.10 0.10 0.11 1 @range 0 1 @color
    color: vec4f,
    /// Linear premultiplied colour of the other half. @default 0.30 0.30 0.32 1 @range 0 1 @color
    other_color: vec4f,
    /// Squares over the height of the picture. @default 16 @range 1 256
    squares: f32,
}

// `place` is in the view plane: -1..1 over the height, y up.
fn pattern_color(place: vec2f) -> vec4f {
    let square = floor(place * 0.5 * params.squares);
    let is_other = fract((square.x + square.y) * 0.5) > 0.25;
    return select(params.color, params.other_color, is_other);
}
