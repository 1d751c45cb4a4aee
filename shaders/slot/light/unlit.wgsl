// How a point is lit: not at all; it shows its own colour.
#import "lib/classified.wgsl"
#import "lib/surface_point.wgsl"

// Linear premultiplied colour of a segment towards the eye.
fn light_segment(classified: Classified, segment: Segment, ray: Ray) -> vec3f {
    return classified.color;
}

// Linear colour of an opaque surface towards the eye.
fn light_surface(color: vec3f, point: SurfacePoint, ray: Ray) -> vec3f {
    return color;
}
