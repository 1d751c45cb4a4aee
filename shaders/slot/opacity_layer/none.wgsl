// Opacity of what the ray met. Nobody reads it.
#import "lib/shown.wgsl"

fn opacity_layer(shown: Shown, pixel: vec2i) {
}
