// The first isosurface that the ray meets, opaque and lit.
#import "lib/crossing.wgsl"
#import "lib/cut_face.wgsl"
#import "lib/isovalue.wgsl"
#import "lib/surface.wgsl"
#import slot "light"

struct Params {
    /// Linear colour of the isosurface. @default 0.8 0.75 0.65 @range 0 1 @color
    surface_color: vec3f,
}

struct TechniqueState {
    color: vec4f,
    depth: f32,
    face: CutFace,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(vec4f(0.0), RAY_NO_DEPTH, cut_face_begin());
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    var distance = 0.0;
    var normal = vec3f(0.0);
    var scalar = isovalue_level();
    if cut_face_is_met((*state).face, *ray, segment) {
        normal = surface_entry_normal(*ray);
        scalar = segment.front.scalar;
    } else {
        distance = crossing_next(*ray, segment, scalar, -1.0);
        if distance == CROSSING_NONE {
            (*state).face = cut_face_after(*ray, segment);
            return false;
        }
        normal = surface_gradient_normal(*ray, distance);
    }
    let point = SurfacePoint(ray_world(*ray, distance), ray_position(*ray, distance), normal, scalar);
    (*state).color = vec4f(light_surface(params.surface_color, point, *ray), 1.0);
    (*state).depth = (*ray).near + distance;
    return true;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return RayResult(state.color, state.depth);
}
