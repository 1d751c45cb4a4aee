// Which parts of a slab are seen: all of it.
#import "lib/slab.wgsl"

// The ray through a pixel, as far as anybody asks; its entry and slope are the caller's.
fn slab_ray(pixel: vec2f, per_depth: f32) -> Ray {
    var ray: Ray;
    return ray;
}

// What is seen of a slab between two samples along a ray.
fn slab_classify(ray: Ray, segment: Segment) -> Classified {
    return classify_segment(ray, segment);
}
