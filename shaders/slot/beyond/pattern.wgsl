// What a bent ray sees behind the volume: the background's own pattern, which has no end to the sides.
#import slot "pattern"

// `place` is in the view plane: -1..1 over the height, y up.
fn beyond_at(place: vec2f) -> vec4f {
    return pattern_color(place);
}
