// World normal, towards the eye, of what the ray shows; w is 1 where there is one. Nobody reads it.
#import "lib/shown.wgsl"

fn normal_layer(shown: Shown, pixel: vec2i) {
}
