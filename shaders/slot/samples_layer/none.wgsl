// Samples of the volume that the walk took (Röttger et al. 2003, figure 6). Nobody reads it.
#import "lib/shown.wgsl"

fn samples_layer(shown: Shown, pixel: vec2i) {
}
