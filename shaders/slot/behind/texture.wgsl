// What lies behind the volume: the picture at the input port `behind`.
#import "lib/behind.wgsl"

fn behind_color(pixel: vec2i) -> vec4f {
    return textureLoad(behind, pixel, 0);
}
