// Average projection: the mean scalar along the ray, by the trapezoid rule (order 2 in the step).
// @walks pairs
#import "lib/ray.wgsl"
#import slot "tone"

struct TechniqueState {
    sum: f32,
    length: f32,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(0.0, 0.0);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    (*state).sum += 0.5 * (segment.front.scalar + segment.back.scalar) * segment.length;
    (*state).length += segment.length;
    return false;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    if state.length <= 0.0 {
        return ray_nothing();
    }
    return RayResult(tone_color(state.sum / state.length), RAY_NO_DEPTH);
}
