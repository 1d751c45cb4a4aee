// Which part of the ray is visible: all of it.
#import "lib/ray.wgsl"

// World distances from the ray's entry: where the first visible part starts and ends; the same twice for none.
fn clip_next(ray: Ray) -> vec2f {
    return vec2f(0.0, ray.far - ray.near);
}

// World normal, towards the eye, of the cut at a distance from the ray's entry where a visible part starts.
fn clip_normal(ray: Ray, distance: f32) -> vec3f {
    return vec3f(0.0);
}
