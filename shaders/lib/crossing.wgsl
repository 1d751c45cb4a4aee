// Where the field crosses a level inside of a segment.
#import "lib/ray.wgsl"
#import slot "reconstruct"

struct Params {
    /// How crossings are found inside of a segment: `none` takes its end, `linear` interpolates.
    /// @default linear @choices none linear
    refinement: u32,
}

// Stands for no crossing.
const CROSSING_NONE: f32 = 3.0e38;

// World distance from the ray's entry to the first crossing of a level in the segment that is farther than `after`;
// CROSSING_NONE where there is none.
fn crossing_next(ray: Ray, segment: Segment, level: f32, after: f32) -> f32 {
    let front = segment.front.scalar - level;
    let back = segment.back.scalar - level;
    if (front >= 0.0) == (back >= 0.0) {
        return CROSSING_NONE;
    }
    let part = select(1.0, front / (front - back), params.refinement == 1u);
    let distance = segment.start + segment.length * part;
    return select(CROSSING_NONE, distance, distance > after);
}
