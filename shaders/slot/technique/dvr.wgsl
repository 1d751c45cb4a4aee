// Direct volume rendering: emission and absorption, composited from front to back (Max 1995).
#import "lib/ray.wgsl"
#import slot "classify"
#import slot "light"

struct Params {
    /// A ray ends where less than this share of the light behind could still reach the eye: a bound on the error.
    /// 0 never ends early. @default 0.000244140625 @range 0 0.5
    early_termination: f32,
}

struct TechniqueState {
    color: vec3f,
    transmittance: f32,
    depth: f32,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(vec3f(0.0), 1.0, RAY_NO_DEPTH);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let classified = classify_segment(*ray, segment);
    let before = (*state).transmittance;
    let after = before * classified.transmittance;
    if classified.transmittance < 1.0 {
        (*state).color += before * light_segment(classified, segment, *ray);
        if before > 0.5 && after <= 0.5 {
            // Inside the segment the extinction is taken as constant.
            let part = log(2.0 * before) / -log(max(classified.transmittance, 1.0e-30));
            (*state).depth = (*ray).near + segment.start + segment.length * clamp(part, 0.0, 1.0);
        }
    }
    (*state).transmittance = after;
    return after < params.early_termination;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return RayResult(vec4f(state.color, 1.0 - state.transmittance), state.depth);
}
