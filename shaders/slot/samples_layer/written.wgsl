// Samples of the volume that the walk took (Röttger et al. 2003, figure 6).
#import "lib/shown.wgsl"

@group(0) @binding(7) var samples_out: texture_storage_2d<r32float, write>;

fn samples_layer(shown: Shown, pixel: vec2i) {
    textureStore(samples_out, pixel, vec4f(f32(shown.samples)));
}
