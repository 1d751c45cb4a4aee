// Up to eight translucent isosurfaces, lit and composited from front to back in the order in which the ray meets them,
// also where it meets several in one segment, or one several times.
// @skips isosurfaces
#import "lib/compositing.wgsl"
#import "lib/crossing.wgsl"
#import "lib/isosurfaces.wgsl"
#import "lib/surface.wgsl"
#import slot "light"

struct TechniqueState {
    composite: Composite,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(compositing_begin());
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let count = min(params.surfaces, ISOSURFACES_MAX);
    // World distance from the ray's entry to the next crossing of each.
    var next: array<f32, 8>;
    var is_met = false;
    for (var index = 0u; index < count; index++) {
        next[index] = crossing_next(*ray, segment, isosurfaces_at(index).level, -1.0);
        is_met = is_met || next[index] != CROSSING_NONE;
    }
    if !is_met {
        return false;
    }
    var composite = (*state).composite;
    let rises = segment.back.scalar >= segment.front.scalar;
    for (var turn = 0u; turn < ISOSURFACES_MAX * CROSSING_MAX && !compositing_is_done(composite); turn++) {
        var nearest = 0u;
        var isosurface = isosurfaces_at(0u);
        for (var index = 1u; index < count; index++) {
            let other = isosurfaces_at(index);
            // At one distance, as at the end of a segment without refinement, the field's own order.
            let is_first = rises == (other.level < isosurface.level) && other.level != isosurface.level;
            if next[index] < next[nearest] || (next[index] == next[nearest] && is_first) {
                nearest = index;
                isosurface = other;
            }
        }
        let distance = next[nearest];
        if distance == CROSSING_NONE {
            break;
        }
        let normal = surface_gradient_normal(*ray, distance);
        let position = ray_position(*ray, distance);
        let point = SurfacePoint(ray_world(*ray, distance), position, normal, isosurface.level);
        let color = light_surface(isosurface.color.xyz, point, *ray);
        composite = compositing_surface(composite, *ray, distance, color, isosurface.color.w);
        next[nearest] = crossing_next(*ray, segment, isosurface.level, distance);
    }
    (*state).composite = composite;
    return compositing_is_done(composite);
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return compositing_result(state.composite);
}
