// What lies behind the volume: nothing.

fn behind_color(pixel: vec2i) -> vec4f {
    return vec4f(0.0);
}
