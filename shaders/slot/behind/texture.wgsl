// What lies behind the volume: the picture at the input port `behind`.

@group(0) @binding(2) var behind: texture_2d<f32>;

fn behind_color(pixel: vec2i) -> vec4f {
    return textureLoad(behind, pixel, 0);
}
