// World distance along the ray, from the eye, to what it shows.
#import "lib/shown.wgsl"

@group(0) @binding(4) var depth_out: texture_storage_2d<r32float, write>;

fn depth_layer(shown: Shown, pixel: vec2i) {
    let skipped = select(0.0, shown.ray.skipped, shown_is_something(shown));
    textureStore(depth_out, pixel, vec4f(shown.result.depth + skipped));
}
