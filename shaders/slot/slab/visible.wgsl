// Which parts of a slab are seen: those that the slot `clip` leaves, cut where the clip shape is, whatever the planes are
// (accurate clipping of slabs: Röttger et al. 2003, section 2).
#import "lib/sample.wgsl"
#import "lib/slab.wgsl"
#import slot "parts"

// Whatever a clip shape is, a slab has an end of parts.
const SLAB_MAX_PARTS: u32 = 64u;

// The ray through a pixel, as far as anybody asks; its entry, where it meets the plane through the box's middle, and slope
// are the caller's.
fn slab_ray(pixel: vec2f, per_depth: f32) -> Ray {
    var ray = ray_through(pixel);
    ray.near = dot(volume.centre - ray.origin, camera.forward) * per_depth;
    return ray;
}

// What is seen of a slab between two samples along a ray.
fn slab_classify(ray: Ray, segment: Segment) -> Classified {
    var part = ray_between(ray, segment.start, segment.start + segment.length);
    var parts = parts_begin(part);
    var seen = Classified(vec3f(0.0), 1.0);
    for (var turn = 0u; turn < SLAB_MAX_PARTS; turn++) {
        if !parts_next(&parts, &part) {
            break;
        }
        let length = part.far - part.near;
        let between = segment_between(sample_along(part, 0.0), sample_along(part, length), 0.0, length);
        seen = classified_behind(seen, classify_segment(part, between));
    }
    return seen;
}
