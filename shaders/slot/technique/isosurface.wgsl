// The first isosurface that the ray meets, opaque and lit.
// @order 1 where refinement=none
// @order 2 where refinement=linear
// @skips isovalue
#import "lib/first_hit.wgsl"
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
    let hit = first_hit((*state).face, *ray, segment);
    (*state).face = hit.face;
    if !hit.is_met {
        return false;
    }
    (*state).color = vec4f(light_surface(params.surface_color, hit.point, *ray), 1.0);
    (*state).depth = hit.depth;
    return true;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return RayResult(state.color, state.depth);
}
