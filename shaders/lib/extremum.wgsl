// The largest scalar along a ray, and where it is; of the negated field the smallest.
#import "lib/cell.wgsl"

struct Params {
    /// What a projection takes the extremum of: `samples`, those of the walk (order 2 in the step), or `field`, the trilinear
    /// field between them as well, cell by cell: exact at any step. `field` needs the slot `reconstruct` to be `trilinear`;
    /// with others the default is `samples`. @default field @choices samples field
    extremum: u32,
}

struct Extremum {
    // The scalar times the sign, its world distance along the ray from the eye, and what label it is of.
    value: f32,
    depth: f32,
    label: u32,
}

// The value that is reached, for leaps over what cannot be beyond it.
var<private> extremum_reached: f32;

fn extremum_begin() -> Extremum {
    extremum_reached = -3.0e38;
    return Extremum(-3.0e38, RAY_NO_DEPTH, 0u);
}

fn extremum_take(best: ptr<function, Extremum>, value: f32, depth: f32, label: u32) {
    if value > (*best).value {
        *best = Extremum(value, depth, label);
        extremum_reached = max(extremum_reached, value);
    }
}

// Takes a segment in. `field_sign` is 1 for the largest scalar, -1 for the smallest.
fn extremum_segment(best: ptr<function, Extremum>, ray: Ray, segment: Segment, field_sign: f32) {
    let depth = ray.near + segment.start;
    extremum_take(best, field_sign * segment.front.scalar, depth, ray.label);
    extremum_take(best, field_sign * segment.back.scalar, depth + segment.length, ray.label);
    if params.extremum == 0u {
        return;
    }
    var cell = cell_begin(ray, segment.start, segment.start + segment.length);
    var values = cell_values(cell.index, 0.0);
    for (var turn = 0u; turn < CELL_MAX; turn++) {
        // Inside of a cell the field stays between its corners.
        let most = max(field_sign * values.low, field_sign * values.high);
        if max(max(most.x, most.y), max(most.z, most.w)) > (*best).value {
            let cubic = cell_cubic(ray, cell, values);
            let extremes = cell_cubic_extremes(cubic);
            let places = vec4f(0.0, extremes, 1.0);
            for (var i = 0u; i < 4u; i++) {
                let value = field_sign * cell_cubic_at(cubic, places[i]);
                let at = ray.near + cell.start + places[i] * (cell.end - cell.start);
                extremum_take(best, value, at, ray.label);
            }
        }
        let index = cell.index;
        if !cell_next(ray, &cell) {
            break;
        }
        values = cell_values_behind(values, index, cell.index, 0.0);
    }
}
