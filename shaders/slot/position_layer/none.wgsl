// World position of what the ray shows, counted from the middle of all volumes; w is 1 where there is one. Nobody reads it.
#import "lib/shown.wgsl"

fn position_layer(shown: Shown, pixel: vec2i) {
}
