// X-ray projection: what the scalars along the ray absorb of a light behind (Beer-Lambert), by the trapezoid rule.
// @walks pairs
#import "lib/window.wgsl"

struct Params {
    /// Absorption of the window's high end, over half of the smallest side of the volume's box; none at its low end and
    /// below. @default 2 @range 0 1000
    absorption: f32,
    /// Linear colour of what absorbs everything. @default 1 1 1 @range 0 1 @color
    film: vec3f,
}

struct TechniqueState {
    sum: f32,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(0.0);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let front = max(window_share(segment.front.scalar), 0.0);
    let back = max(window_share(segment.back.scalar), 0.0);
    (*state).sum += 0.5 * (front + back) * segment.length;
    return false;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    let opacity = 1.0 - exp(-params.absorption * state.sum / volume.half_side);
    return RayResult(vec4f(params.film * opacity, opacity), RAY_NO_DEPTH);
}
