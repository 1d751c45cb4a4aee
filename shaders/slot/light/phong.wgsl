// How a point is lit: Blinn-Phong, the gradient at a segment's centre as the normal, seen from both sides.
// Where the field is flat there is no surface, and the colour stays as it is.
#import "lib/classified.wgsl"
#import "lib/phong.wgsl"
#import "lib/surface.wgsl"
#import slot "material"

// Linear premultiplied colour of a segment towards the eye.
fn light_segment(classified: Classified, segment: Segment, ray: Ray) -> vec3f {
    let distance = segment.start + 0.5 * segment.length;
    let facing = surface_inner(ray, distance);
    let material = material_segment(classified, segment, ray);
    let lit = phong_color(material, ray_world(ray, distance), facing, -ray.direction, false);
    return select(lit, classified.color, facing.per_length == 0.0);
}

// Linear colour of an opaque surface towards the eye.
fn light_surface(color: vec3f, point: SurfacePoint, ray: Ray) -> vec3f {
    return phong_surface(color, point, ray);
}
