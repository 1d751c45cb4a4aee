// Which parts of a slab are seen: all of it.
#import "lib/slab.wgsl"

// What is seen of a slab between two samples along a ray.
fn slab_classify(ray: Ray, segment: Segment) -> Classified {
    return classify_segment(ray, segment);
}
