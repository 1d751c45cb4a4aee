// World distance along the ray to what it shows. Nobody reads it.
#import "lib/shown.wgsl"

fn depth_layer(shown: Shown, pixel: vec2i) {
}
