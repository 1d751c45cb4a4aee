// World normal, towards the eye, of what the ray shows; w is 1 where there is one.
#import "lib/shown.wgsl"
#import "lib/surface.wgsl"

@group(0) @binding(9) var normal_out: texture_storage_2d<rgba32float, write>;

fn normal_layer(shown: Shown, pixel: vec2i) {
    var normal = vec4f(0.0);
    if shown_is_something(shown) {
        normal = vec4f(surface_normal(shown.ray, shown_distance(shown)), 1.0);
    }
    textureStore(normal_out, pixel, normal);
}
