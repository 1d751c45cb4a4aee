// The first point of a solid that a ray meets: of its isosurface, or of its face where a cut or the box goes through it.
#import "lib/crossing.wgsl"
#import "lib/cut_face.wgsl"
#import "lib/isovalue.wgsl"
#import "lib/surface.wgsl"

struct FirstHit {
    is_met: bool,
    // World distance along the ray from the eye.
    depth: f32,
    // Its normal is zeros where it is the field's (`first_hit_point`).
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
        normal = first_hit_entry_normal(ray);
        scalar = segment.front.scalar;
    } else {
        distance = crossing_next(ray, segment, scalar, -1.0);
        if distance == CROSSING_NONE {
            hit.face = cut_face_after(ray, segment);
            return hit;
        }
    }
    hit.is_met = true;
    hit.depth = ray.near + distance;
    hit.point = SurfacePoint(ray_world(ray, distance), ray_position(ray, distance), normal, scalar);
    return hit;
}

// The normal of the cut or the face that a part of a ray starts at; zeros where it starts at neither.
fn first_hit_entry_normal(ray: Ray) -> vec3f {
    if any(ray.cut_normal != vec3f(0.0)) || !volume_is_at_face(ray) {
        return ray.cut_normal;
    }
    return volume_face_normal(ray);
}

// The point with its normal: once it is found, and not in the walk, where software drivers look for it in every segment.
fn first_hit_point(given: SurfacePoint, ray: Ray) -> SurfacePoint {
    var point = given;
    if all(point.normal == vec3f(0.0)) {
        point.normal = surface_towards_eye(gradient_at(point.position), ray.direction);
    }
    return point;
}
