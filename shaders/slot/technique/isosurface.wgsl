// The first isosurface that the ray meets, opaque and lit.
// @order 1 where refinement=none
// @order 2 where refinement=linear
// @skips isovalue
// @heeds isovalue
#import "lib/first_hit.wgsl"
#import slot "labels"
#import slot "light"

struct Params {
    /// Linear colour of the isosurface. @default 0.8 0.75 0.65 @range 0 1 @color
    surface_color: vec3f,
}

struct TechniqueState {
    // What is met, to be lit when the walk is over, and of what label it is.
    point: SurfacePoint,
    depth: f32,
    label: u32,
    face: CutFace,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    let nothing = SurfacePoint(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0);
    return TechniqueState(nothing, RAY_NO_DEPTH, 0u, cut_face_begin());
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let hit = first_hit((*state).face, *ray, segment);
    *state = TechniqueState(hit.point, hit.depth, (*ray).label, hit.face);
    return hit.is_met;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    if state.depth >= RAY_NO_DEPTH {
        return ray_nothing();
    }
    labels_select(state.label);
    let point = first_hit_point(state.point, ray);
    return RayResult(vec4f(light_surface(params.surface_color, point, ray), 1.0), state.depth);
}
