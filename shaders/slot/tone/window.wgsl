// What does a projected scalar look like: from nothing at the window's low end to one colour at its high end.
#import "lib/window.wgsl"

struct Params {
    /// Linear colour of the window's high end. @default 1 1 1 @range 0 1 @color
    window_color: vec3f,
}

// Linear premultiplied colour.
fn tone_color(scalar: f32) -> vec4f {
    let share = clamp(window_share(scalar), 0.0, 1.0);
    return vec4f(params.window_color * share, share);
}
