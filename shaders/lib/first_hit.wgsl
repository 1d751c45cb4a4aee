// The first point of a solid that a ray meets: of its isosurface, or of its face where a cut or the box goes through it.
#import "lib/crossing.wgsl"
#import "lib/cut_face.wgsl"
#import "lib/isovalue.wgsl"
#import "lib/surface.wgsl"

struct FirstHit {
    is_met: bool,
    // World distance along the ray from the eye.
    depth: f32,
    point: SurfacePoint,
    // What the walk has come through; the next segment's `face`.
    face: CutFace,
}

// Looks for it in a segment; `face` is that of the segment before, or `cut_face_begin()`.
fn first_hit(face: CutFace, ray: Ray, segment: Segment) -> FirstHit {
    var hit = FirstHit(false, RAY_NO_DEPTH, SurfacePoint(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0), face);
    var distance = 0.0;
    var normal = vec3f(0.0);
    var scalar = isovalue_level();
    if cut_face_is_met(face, ray, segment) {
        normal = surface_entry_normal(ray);
        scalar = segment.front.scalar;
    } else {
        distance = crossing_next(ray, segment, scalar, -1.0);
        if distance == CROSSING_NONE {
            hit.face = cut_face_after(ray, segment);
            return hit;
        }
        normal = surface_gradient_normal(ray, distance);
    }
    hit.is_met = true;
    hit.depth = ray.near + distance;
    hit.point = SurfacePoint(ray_world(ray, distance), ray_position(ray, distance), normal, scalar);
    return hit;
}
