// What a bent ray sees behind the volume: nothing.

// `place` is in the view plane: -1..1 over the height, y up.
fn beyond_at(place: vec2f) -> vec4f {
    return vec4f(0.0);
}
