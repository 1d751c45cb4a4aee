// How fast a transfer function changes with the scalar: how long segments may be that meet scalars of a range.

struct Importance {
    // Entry of a scalar: (scalar - low) * per_scalar.
    low: f32,
    per_scalar: f32,
    // The cube of a segment's length in steps, times how much its function bends per world length.
    cubes: f32,
    // How much the changes of slopes count, per world length.
    bends: f32,
    // The steepest slope in an entry; how much slopes change in all up to its start, and up to its end.
    entries: array<vec4f, 512>,
}

@group(2) @binding(41) var<uniform> importance: Importance;

// The steps that a segment may take where scalars go from low to high, and change by `detail`: the largest first and
// second derivative along any direction.
fn importance_steps(low: f32, high: f32, detail: vec2f) -> f32 {
    let places = clamp((vec2f(low, high) - importance.low) * importance.per_scalar, vec2f(0.0), vec2f(511.0));
    let first = importance.entries[u32(places.x)];
    let last = importance.entries[u32(places.y)];
    let bent = last.z - first.y;
    // From an end to the steepest place and back, slopes change by twice of what it is steeper.
    let steepest = max(first.x, last.x) + 0.5 * bent;
    let curvature = steepest * detail.y + importance.bends * bent * detail.x;
    return pow(importance.cubes / max(curvature, 1.0e-30), 1.0 / 3.0);
}
