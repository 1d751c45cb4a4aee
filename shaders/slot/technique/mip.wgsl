// Maximum intensity projection: the largest scalar along the ray.
// @skips maximum
// @walks pairs
#import "lib/extremum.wgsl"
#import slot "labels"
#import slot "tone"

struct TechniqueState {
    best: Extremum,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(extremum_begin());
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    var best = (*state).best;
    extremum_segment(&best, *ray, segment, 1.0);
    (*state).best = best;
    return false;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    let best = state.best;
    if best.depth >= RAY_NO_DEPTH {
        return ray_nothing();
    }
    labels_select(best.label);
    return RayResult(tone_color(best.value), best.depth);
}
