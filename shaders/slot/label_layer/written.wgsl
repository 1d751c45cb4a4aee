// Label of what the ray shows.
#import "lib/shown.wgsl"
#import slot "labels"

@group(0) @binding(10) var label_out: texture_storage_2d<r32float, write>;

fn label_layer(shown: Shown, pixel: vec2i) {
    var label = 0u;
    if shown_is_something(shown) {
        // On the very boundary two labels are as near; the part knows which one is shown.
        let distance = shown_distance(shown);
        label = shown.ray.label;
        if distance < 0.0 {
            label = labels_at(ray_position(shown.ray, distance));
        }
    }
    textureStore(label_out, pixel, vec4f(f32(label)));
}
