// Estimated integration error of the colour (Richardson): a second walk goes along with double segments, made of two
// each, so that it reads no sample anew; a technique has a state in each walk. By pairs of segments, the difference of the
// two colours changes by what the pair gets wrong, as far as it is seen. The estimate is the root of the sum of the
// squares of these changes and of the whole difference, and the light that was left where the walk ended early.
//
// Of what was measured on all ready graphs: the whole difference alone is too small in up to 6 of 100 pixels, where
// errors of opposite signs happen to cancel; the sum of the changes' sizes is up to 40 times too large; divided by 3, as
// for order 2, all are too small, for trilinear fields have kinks at the faces of cells. A segment without a partner, at
// the end of a part or alone in one (as behind a cut), is the same in both walks: it is compared with its halves instead.
// Rays that a technique bends are walked a second time, and have the whole difference alone. Not estimated: what is
// integrated elsewhere (shadows, tables), and where `clip_method: naive` cuts.
#import slot "parts"
#import "lib/sample.wgsl"
#import "lib/shown.wgsl"
#import slot "behind"
#import slot "labels"
#import slot "technique"
#import slot "traverse"

struct ErrorLayer {
    // The walk with double segments, and whether its technique is done.
    double: TechniqueState,
    is_done: bool,
    // The first segment of a pair that waits for its second one.
    first: Segment,
    has_first: bool,
    // How many segments of the part have been seen.
    count: u32,
    // Whether either walk has bent its ray: they share no samples then.
    is_bent: bool,
    pixel: vec2f,
    behind: vec4f,
    // Of the colour over what is behind: how much it differs from that of double segments; of segments without a partner;
    // and the squares of what each pair changes.
    difference: vec4f,
    alone: vec4f,
    squares: vec4f,
}

@group(0) @binding(11) var error_out: texture_storage_2d<r32float, write>;

// Whatever the slots say, a walk ends (see RAYCAST_MAX_SEGMENTS).
const ERROR_LAYER_MAX_SEGMENTS: u32 = 65535u;
// A segment's error is more than its difference to its halves: by a third for order 2, twice for order 1.
const ERROR_LAYER_ALONE: f32 = 2.0;

fn error_layer_begin(ray: Ray, pixel: vec2f) -> ErrorLayer {
    var walk: ErrorLayer;
    walk.double = technique_begin(ray);
    walk.pixel = pixel;
    walk.behind = behind_color(vec2i(pixel));
    return walk;
}

// Goes along with the walk: before each of its segments, `state` being its technique's.
fn error_layer_segment(walk: ptr<function, ErrorLayer>, state: TechniqueState, ray: Ray, segment: Segment) {
    (*walk).is_bent = (*walk).is_bent || ray.bends > 0u;
    if (*walk).is_bent {
        return;
    }
    (*walk).count = select((*walk).count, 0u, segment.start == 0.0) + 1u;
    if (*walk).has_first {
        error_layer_double(walk, ray, error_layer_pair((*walk).first, segment));
        return;
    }
    error_layer_compare(walk, state, ray);
    let rest = ray.far - ray.near - (segment.start + segment.length);
    // What a much shorter partner would change says nothing.
    if rest < 0.5 * segment.length {
        let change = ERROR_LAYER_ALONE * error_layer_halves(state, ray, segment, (*walk).behind);
        (*walk).alone += change;
        (*walk).squares += change * change;
        error_layer_double(walk, ray, segment);
        return;
    }
    (*walk).first = segment;
    (*walk).has_first = true;
}

// The estimate, at the end of the walk.
fn error_layer_finish(walk: ptr<function, ErrorLayer>, state: TechniqueState, ray: Ray, is_done: bool) -> f32 {
    if (*walk).is_bent || ray.bends > 0u {
        let other = error_layer_walk((*walk).pixel, (*walk).behind);
        (*walk).difference = error_layer_color(state, ray, (*walk).behind) - other;
        (*walk).squares = (*walk).difference * (*walk).difference;
    } else {
        if (*walk).has_first {
            // The walk has ended within a pair.
            let first = (*walk).first;
            let start = first.start + first.length;
            let end = min(start + first.length, ray.far - ray.near);
            let back = sample_along(ray, end);
            error_layer_double(walk, ray, error_layer_pair(first, segment_between(first.back, back, start, end - start)));
        }
        error_layer_compare(walk, state, ray);
    }
    let whole = abs((*walk).difference) + abs((*walk).alone);
    var estimate = sqrt(whole * whole + (*walk).squares);
    if is_done {
        let left = 1.0 - technique_finish(state, ray).color.w;
        estimate += left * max(vec4f(1.0), (*walk).behind);
    }
    return max(max(estimate.x, estimate.y), max(estimate.z, estimate.w));
}

// One segment of two.
fn error_layer_pair(first: Segment, second: Segment) -> Segment {
    let is_even = abs(second.length - first.length) < 1.0e-3 * first.length;
    let length = first.length + second.length;
    return Segment(first.front, second.back, first.start, length, second.front.scalar, is_even, false);
}

// A segment of the walk with double ones.
fn error_layer_double(walk: ptr<function, ErrorLayer>, ray: Ray, segment: Segment) {
    (*walk).has_first = false;
    if (*walk).is_done {
        return;
    }
    var own = ray;
    var state = (*walk).double;
    (*walk).is_done = technique_segment(&state, &own, segment);
    (*walk).double = state;
    (*walk).is_bent = own.bends > 0u;
}

fn error_layer_compare(walk: ptr<function, ErrorLayer>, state: TechniqueState, ray: Ray) {
    let behind = (*walk).behind;
    let difference = error_layer_color(state, ray, behind) - error_layer_color((*walk).double, ray, behind);
    let change = difference - (*walk).difference;
    (*walk).difference = difference;
    (*walk).squares += change * change;
}

// The colour over what is behind, were the walk to end here.
fn error_layer_color(state: TechniqueState, ray: Ray, behind: vec4f) -> vec4f {
    // Techniques may select labels in the end.
    let label = labels_selected();
    let color = technique_finish(state, ray).color;
    labels_select(label);
    return color + select(1.0 - color.w, 0.0, ray.bends > 0u) * behind;
}

// How much the colour differs if a segment is walked in two halves.
fn error_layer_halves(before: TechniqueState, ray: Ray, segment: Segment, behind: vec4f) -> vec4f {
    let half = 0.5 * segment.length;
    let middle = sample_along(ray, segment.start + half);
    var state = before;
    var whole = vec4f(0.0);
    var is_done = false;
    for (var turn = 0u; turn < 3u; turn++) {
        var piece = segment;
        if turn == 1u {
            whole = error_layer_color(state, ray, behind);
            state = before;
            is_done = false;
            piece = segment_between(segment.front, middle, segment.start, half);
        } else if turn == 2u {
            piece = segment_between(middle, segment.back, segment.start + half, half);
        }
        if !is_done {
            var own = ray;
            is_done = technique_segment(&state, &own, piece);
        }
    }
    return error_layer_color(state, ray, behind) - whole;
}

// The colour of a walk of its own with double segments.
fn error_layer_walk(pixel: vec2f, behind: vec4f) -> vec4f {
    labels_select(STRETCH_NO_LABEL);
    var ray = volume_clip_ray(ray_through(pixel));
    var parts = parts_begin(ray);
    var state = technique_begin(ray);
    var is_done = false;
    for (var part = 0u; !is_done && part < ERROR_LAYER_MAX_SEGMENTS; part++) {
        if !parts_next(&parts, &ray) {
            break;
        }
        let length = ray.far - ray.near;
        var front = sample_along(ray, 0.0);
        var start = 0.0;
        for (var index = 1u; start < length && index < ERROR_LAYER_MAX_SEGMENTS; index += 2u) {
            let end = traverse_segment_end(ray, index);
            let back = sample_along(ray, end);
            is_done = technique_segment(&state, &ray, segment_between(front, back, start, end - start));
            if is_done || ray.bends != parts.bends {
                break;
            }
            front = back;
            start = end;
        }
    }
    labels_select(STRETCH_NO_LABEL);
    return error_layer_color(state, ray, behind);
}

fn error_layer(shown: Shown, pixel: vec2i) {
    textureStore(error_out, pixel, vec4f(shown.error));
}
