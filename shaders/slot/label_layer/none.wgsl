// Label of what the ray shows. Nobody reads it.
#import "lib/shown.wgsl"

fn label_layer(shown: Shown, pixel: vec2i) {
}
