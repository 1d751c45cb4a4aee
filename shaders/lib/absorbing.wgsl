// The scalars that transfer functions make absorb: open intervals, rising; of a segmented volume, of all labels together.

struct Absorbing {
    count: u32,
    // An interval's ends in the first two.
    spans: array<vec4f, 64>,
}

@group(2) @binding(40) var<uniform> absorbing: Absorbing;

// Whether anything absorbs between two scalars.
fn absorbing_between(low: f32, high: f32) -> bool {
    for (var index = 0u; index < min(absorbing.count, 64u); index++) {
        let span = absorbing.spans[index];
        if high > span.x && low < span.y {
            return true;
        }
    }
    return false;
}
