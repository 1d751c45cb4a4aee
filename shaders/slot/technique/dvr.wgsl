// Direct volume rendering: emission and absorption, composited from front to back (Max 1995).
// @skips transfer
// @heeds absorbing
// @walks pairs
#import "lib/compositing.wgsl"
#import slot "classify"
#import slot "colors"
#import slot "light"

struct TechniqueState {
    composite: Composite,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(compositing_begin());
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let classified = colors_segment(classify_segment(*ray, segment), *ray, segment);
    if classified.transmittance < 1.0 {
        let color = light_segment(classified, segment, *ray);
        (*state).composite = compositing_segment((*state).composite, *ray, segment, color, classified.transmittance);
    }
    return compositing_is_done((*state).composite);
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return compositing_result(state.composite);
}
