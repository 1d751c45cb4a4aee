// Volume rendering along bent rays: the transfer function's refractive index bends them (Stegmaier et al. 2005), emission
// and absorption are those of `dvr`. Directions follow the ray equation of geometrical optics, d/ds (n dr/ds) = grad n,
// by a leapfrog scheme: order 2 in the step. Where n does not change, rays stay straight. The faces of the box and of
// cuts bend nothing: the medium is thought to go on beyond them.
#import "lib/beyond.wgsl"
#import "lib/compositing.wgsl"
#import "lib/refraction.wgsl"
#import slot "classify"
#import slot "gradient"
#import slot "light"

struct Params {
    /// A ray ends after such a way through the volume, in diagonals of its box: media can trap rays for ever.
    /// @default 4 @range 1 64
    longest_way: f32,
}

struct TechniqueState {
    composite: Composite,
    // World distance from the origin where the ray ends, wherever it is.
    limit: f32,
    // World distance from the origin up to which the ray has been looked at.
    seen: f32,
    // How much of the next segment its direction holds the bending of already.
    ahead: f32,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    let limit = ray.near + params.longest_way * 2.0 * volume.radius;
    return TechniqueState(compositing_begin(), limit, -RAY_NO_DEPTH, 0.0);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let bends = (*ray).bends;
    let end = segment.start + segment.length;
    let reach = 0.5 * abs(segment.back.scalar - segment.front.scalar);
    // Where a ray comes into what is visible of the volume, it is bent at the front of its segment as well.
    let is_entering = segment.start == 0.0 && (*ray).near > (*state).seen + volume_least();
    for (var node = select(1u, 0u, is_entering); node < 2u; node++) {
        var at = segment.front;
        var distance = 0.0;
        var before = 0.0;
        if node == 1u {
            (*state).composite = technique_absorb((*state).composite, *ray, segment);
            if compositing_is_done((*state).composite) || (*ray).near + end > (*state).limit {
                return true;
            }
            at = segment.back;
            distance = end;
            before = segment.length - (*state).ahead;
        }
        (*state).seen = (*ray).near + distance;
        // The next segment is as long as this one, or ends where what is visible does. If it does not, its own end makes
        // up for it.
        let behind = 0.5 * clamp((*ray).visible_end - (*state).seen, 0.0, segment.length);
        (*state).ahead = behind;
        technique_bend(ray, at, distance, reach, before, behind);
        if (*ray).bends != bends {
            return false;
        }
    }
    return false;
}

fn technique_absorb(before: Composite, ray: Ray, segment: Segment) -> Composite {
    let classified = classify_segment(ray, segment);
    if classified.transmittance >= 1.0 {
        return before;
    }
    let color = light_segment(classified, segment, ray);
    return compositing_segment(before, ray, segment, color, classified.transmittance);
}

// Bends the ray at a sample by what the gradient of n there does over two world lengths, half of the segment before and
// half of the one behind. With n d = v at the sample, the direction before is that of v - before grad n, and the one
// behind that of v + behind grad n.
fn technique_bend(
    ray: ptr<function, Ray>,
    at: Sample,
    distance: f32,
    reach: f32,
    before: f32,
    behind: f32,
) {
    let slope = refraction_slope(at.scalar, reach);
    if slope == 0.0 {
        return;
    }
    let gradient = slope * gradient_at(at.position);
    let direction = (*ray).direction;
    let index = refraction_index(at.scalar);
    let along = before * dot(direction, gradient);
    let square = along * along + index * index - before * before * dot(gradient, gradient);
    let momentum = (sqrt(max(square, 0.0)) - along) * direction + (before + behind) * gradient;
    let bent = momentum / max(length(momentum), 1.0e-20);
    // Less is the rounding of directions.
    if any(abs(bent - direction) > vec3f(1.0e-7)) && dot(bent, bent) > 0.5 {
        volume_bend_ray(ray, distance, bent);
    }
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    var result = compositing_result(state.composite);
    if ray.bends > 0u {
        result.color += state.composite.transmittance * beyond_color(ray_world(ray, 0.0), ray.direction);
    }
    return result;
}
