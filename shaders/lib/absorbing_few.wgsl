// The scalars that the transfer function makes absorb, as four intervals at most: for tests in every segment, in straight line.

struct AbsorbingFew {
    // Ends of the intervals, as far apart as an entry of a table reaches over; of those that there are not, above all
    // scalars and below.
    low: vec4f,
    high: vec4f,
}

@group(2) @binding(42) var<uniform> absorbing_few: AbsorbingFew;

// Whether anything may absorb between two scalars.
fn absorbing_few_between(low: f32, high: f32) -> bool {
    return any((vec4f(high) > absorbing_few.low) & (vec4f(low) < absorbing_few.high));
}
