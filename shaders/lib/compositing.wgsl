// Emission and absorption, composited from front to back (Max 1995).
#import "lib/classified.wgsl"

struct Params {
    /// A ray ends where less than this share of the light behind could still reach the eye: a bound on the error.
    /// 0 never ends early. @default 0.000244140625 @range 0 0.5
    early_termination: f32,
}

// What has been met so far; the depth is where half of the light is gone.
struct Composite {
    color: vec3f,
    transmittance: f32,
    depth: f32,
}

fn compositing_begin() -> Composite {
    return Composite(vec3f(0.0), 1.0, RAY_NO_DEPTH);
}

// Adds a segment that lets `transmittance` of the light through and emits a linear premultiplied colour.
fn compositing_segment(before: Composite, ray: Ray, segment: Segment, color: vec3f, transmittance: f32) -> Composite {
    let after = before.transmittance * transmittance;
    var depth = before.depth;
    if before.transmittance > 0.5 && after <= 0.5 {
        // Inside the segment the extinction is taken as constant.
        let part = log(2.0 * before.transmittance) / -log(max(transmittance, 1.0e-30));
        depth = ray.near + segment.start + segment.length * clamp(part, 0.0, 1.0);
    }
    return Composite(before.color + before.transmittance * color, after, depth);
}

// Adds a surface of a linear colour and an opacity, at a world distance from the ray's entry.
fn compositing_surface(before: Composite, ray: Ray, distance: f32, color: vec3f, opacity: f32) -> Composite {
    let after = before.transmittance * (1.0 - opacity);
    let is_half = before.transmittance > 0.5 && after <= 0.5;
    let depth = select(before.depth, ray.near + distance, is_half);
    return Composite(before.color + (before.transmittance * opacity) * color, after, depth);
}

fn compositing_is_done(composite: Composite) -> bool {
    return composite.transmittance < params.early_termination;
}

fn compositing_result(composite: Composite) -> RayResult {
    return RayResult(vec4f(composite.color, 1.0 - composite.transmittance), composite.depth);
}
