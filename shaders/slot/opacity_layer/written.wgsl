// Opacity of what the ray met.
#import "lib/shown.wgsl"

@group(0) @binding(5) var opacity_out: texture_storage_2d<r32float, write>;

fn opacity_layer(shown: Shown, pixel: vec2i) {
    textureStore(opacity_out, pixel, vec4f(shown.result.color.w));
}
