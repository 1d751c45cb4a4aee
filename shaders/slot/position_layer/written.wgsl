// World position of what the ray shows, counted from the middle of all volumes; w is 1 where there is one.
#import "lib/shown.wgsl"

@group(0) @binding(8) var position_out: texture_storage_2d<rgba32float, write>;

fn position_layer(shown: Shown, pixel: vec2i) {
    let position = vec4f(ray_world(shown.ray, shown_distance(shown)), 1.0);
    textureStore(position_out, pixel, select(vec4f(0.0), position, shown_is_something(shown)));
}
