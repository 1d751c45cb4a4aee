// Where the field crosses a level inside of a segment.
#import "lib/cell.wgsl"
#import "lib/ray.wgsl"
#import slot "reconstruct"

struct Params {
    /// How crossings are found inside of a segment: `none` takes its end (order 1 in the step), `linear` interpolates
    /// (order 2), `bisection` halves and samples, `cubic` solves the trilinear field cell by cell: exact, at any step, with
    /// all crossings. `cubic` needs the slot `reconstruct` to be `trilinear`, with others the default is `bisection` (of
    /// `refraction_surface`, `linear`); the others see only segments whose ends lie on both sides. @default cubic @choices none linear bisection cubic
    refinement: u32,
    /// How often `bisection` halves a segment. @default 6 @range 1 24
    bisections: u32,
}

// Stands for no crossing.
const CROSSING_NONE: f32 = 3.0e38;
// More crossings of one level are not looked for in one segment.
const CROSSING_MAX: u32 = 256u;

// World distance from the ray's entry to the first crossing of a level in the segment that is farther than `after`;
// CROSSING_NONE where there is none.
fn crossing_next(ray: Ray, segment: Segment, level: f32, after: f32) -> f32 {
    if params.refinement == 3u {
        return crossing_cubic(ray, segment, level, after);
    }
    let front = segment.front.scalar - level;
    let back = segment.back.scalar - level;
    if (front >= 0.0) == (back >= 0.0) {
        return CROSSING_NONE;
    }
    var distance = segment.start + segment.length;
    if params.refinement == 1u {
        distance = segment.start + segment.length * (front / (front - back));
    } else if params.refinement == 2u {
        distance = crossing_bisected(ray, segment, level);
    }
    return select(CROSSING_NONE, distance, distance > after);
}

// Whether a segment starts at the level or above it, as its crossings count.
fn crossing_starts_above(ray: Ray, segment: Segment, level: f32) -> bool {
    if params.refinement == 3u {
        return crossing_is_above(ray, segment.start, level);
    }
    return segment.front.scalar >= level;
}

// The middle of what is left after halving: at most half of that beside the crossing.
fn crossing_bisected(ray: Ray, segment: Segment, level: f32) -> f32 {
    let is_above = segment.front.scalar >= level;
    var low = segment.start;
    var high = segment.start + segment.length;
    for (var turn = 0u; turn < min(params.bisections, 24u); turn++) {
        let middle = 0.5 * (low + high);
        if (reconstruct_scalar(ray_position(ray, middle)) >= level) == is_above {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

// Sides are those of the trilinear field at the segment's ends, and each stretch goes on from the side where the one
// before ended: whatever is rounded, no crossing falls between two cells or two segments, and none is met twice. One
// turn looks for a piece of the field's cubic with a crossing in it, cell by cell; its root is found behind that, for
// software drivers run what is in a loop for every cell, needed or not.
fn crossing_cubic(ray: Ray, segment: Segment, level: f32, after: f32) -> f32 {
    let limit = segment.start + segment.length;
    var cell = cell_begin(ray, segment.start, limit);
    var is_above = false;
    var is_begun = false;
    // Up to where the cell has been looked at, and whether it is the one that the next segment starts in.
    var seen = 0.0;
    var is_last = false;
    for (var crossing = 0u; crossing <= CROSSING_MAX; crossing++) {
        var cubic = vec4f(0.0);
        var low = 0.0;
        var high = 0.0;
        var is_met = false;
        for (var turn = 0u; turn < CELL_MAX; turn++) {
            let values = cell_values(cell.index, level);
            if !is_begun {
                is_above = cell_scalar(values, cell_place(ray, cell.index, cell.start)) >= 0.0;
                is_begun = true;
            }
            let lows = values.low >= vec4f(0.0);
            let highs = values.high >= vec4f(0.0);
            let all_above = all(lows) && all(highs);
            let is_mixed = !all_above && (any(lows) || any(highs));
            cubic = cell_cubic(ray, cell, values);
            let extremes = cell_cubic_extremes(cubic);
            let is_end_above = cell_scalar(values, cell_place(ray, cell.index, cell.end)) >= 0.0;
            // Of a cell on one side only its start can be a crossing.
            let has_first = extremes.x > seen;
            let is_first = has_first && (cell_cubic_at(cubic, extremes.x) >= 0.0) != is_above;
            let behind_first = max(seen, extremes.x);
            let is_second = extremes.y > behind_first && (cell_cubic_at(cubic, extremes.y) >= 0.0) != is_above;
            low = select(select(max(behind_first, extremes.y), behind_first, is_second), seen, is_first);
            high = select(select(1.0, extremes.y, is_second), extremes.x, is_first);
            is_met = is_first || is_second || is_end_above != is_above;
            if !is_mixed {
                is_met = all_above != is_above;
                low = 0.0;
                high = 0.0;
            }
            if is_met {
                break;
            }
            seen = 0.0;
            if !cell_next(ray, &cell) {
                // The next segment starts in the cell that its start is in, which may be the one after.
                let next = cell_begin(ray, limit, limit);
                if is_last || all(next.index == cell.index) {
                    break;
                }
                cell = next;
                is_last = true;
            }
        }
        if !is_met {
            break;
        }
        let w = cell_cubic_root(cubic, low, high, is_above);
        let distance = min(cell.start + w * (cell.end - cell.start), limit);
        if distance > after {
            return distance;
        }
        is_above = !is_above;
        seen = high;
    }
    return CROSSING_NONE;
}

// Whether the trilinear field is at a level or above it.
fn crossing_is_above(ray: Ray, distance: f32, level: f32) -> bool {
    let cell = cell_begin(ray, distance, distance);
    return cell_scalar(cell_values(cell.index, level), cell_place(ray, cell.index, distance)) >= 0.0;
}
