// Label of what the ray shows.
#import "lib/shown.wgsl"
#import slot "labels"

@group(0) @binding(10) var label_out: texture_storage_2d<r32float, write>;

fn label_layer(shown: Shown, pixel: vec2i) {
    var label = 0u;
    if shown_is_something(shown) {
        label = labels_at(ray_position(shown.ray, shown_distance(shown)));
    }
    textureStore(label_out, pixel, vec4f(f32(label)));
}
