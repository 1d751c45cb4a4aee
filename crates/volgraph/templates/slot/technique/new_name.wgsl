// A glow: every point of the volume shines and hides nothing, so a pixel is the sum of the light along its ray.
//
// A technique says what each segment of a ray adds to the pixel. The walk along the ray is volgraph's: it calls
// `technique_begin` once, `technique_segment` for each segment from front to back, and `technique_finish` once.
#import "lib/ray.wgsl"
#import "lib/transfer.wgsl"

// Parameters: what their doc comments say is checked in graphs and on the command line, and shown by `volgraph nodes`.
struct Params {
    /// Factor on the light. @default 1 @range 0 100
    brightness: f32,
    /// Linear colour that the light is multiplied with. @default 1 1 1 @range 0 1 @color
    tint: vec3f,
}

// What a ray carries from segment to segment; its members are yours.
struct TechniqueState {
    light: vec3f,
}

// Called before the first segment, also for a ray that misses the volume and has none.
fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(vec3f(0.0));
}

// The light that a point gives off, per world unit of length: the transfer function's colour times its extinction.
fn new_name_emission(scalar: f32) -> vec3f {
    let entry = transfer_at(scalar);
    return entry.xyz * (entry.w * transfer.halvings_per_world);
}

// Called for each segment. It has a sample at its front and one at its back, which is the next one's front. All are
// one step long but the last, which ends where the ray leaves the volume: so weight with `segment.length`, and the
// picture does not depend on the step but for the error of the sum. Return true to end the ray.
fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let front = new_name_emission(segment.front.scalar);
    let back = new_name_emission(segment.back.scalar);
    (*state).light += 0.5 * (front + back) * segment.length;
    return false;
}

// Called after the last segment. The colour is linear and premultiplied: what lies behind shows through by one minus
// the fourth number. A glow hides nothing, so that is 0, and the light is added to the background. The second value is
// the depth of what is seen; nothing here is at one depth.
fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    let light = state.light * params.tint * params.brightness;
    return RayResult(vec4f(light, 0.0), RAY_NO_DEPTH);
}
