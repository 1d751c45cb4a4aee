// Estimated integration error of the colour (experiment).
#import "lib/parts.wgsl"
#import "lib/sample.wgsl"
#import "lib/shown.wgsl"
#import slot "behind"
#import slot "labels"
#import slot "technique"
#import slot "traverse"

struct Params {
    /// Experiment. @default 0 @range 0 20
    error_candidate: u32,
}

struct Doubled {
    state: TechniqueState,
    stride: u32,
    filled: u32,
    open: Segment,
    is_done: bool,
    bends: bool,
    difference: vec4f,
    squares: vec4f,
    sum: vec4f,
    most: vec4f,
}

struct ErrorLayer {
    a: Doubled,
    b: Doubled,
    c: Doubled,
    index: u32,
    behind: vec4f,
    pixel: vec2f,
}

@group(0) @binding(11) var error_out: texture_storage_2d<r32float, write>;

fn doubled_begin(ray: Ray, stride: u32) -> Doubled {
    var d: Doubled;
    d.state = technique_begin(ray);
    d.stride = stride;
    return d;
}

fn error_layer_begin(ray: Ray, pixel: vec2f) -> ErrorLayer {
    var w: ErrorLayer;
    w.a = doubled_begin(ray, 2u);
    w.b = doubled_begin(ray, 2u);
    w.c = doubled_begin(ray, 4u);
    w.behind = behind_color(vec2i(pixel));
    w.pixel = pixel;
    return w;
}

fn doubled_compare(d: ptr<function, Doubled>, state: TechniqueState, ray: Ray, behind: vec4f) {
    let label = labels_selected();
    let fine = technique_finish(state, ray).color;
    let coarse = technique_finish((*d).state, ray).color;
    labels_select(label);
    var diff = fine - coarse;
    diff -= diff.w * behind;
    let change = diff - (*d).difference;
    (*d).difference = diff;
    (*d).squares += change * change;
    (*d).sum += abs(change);
    (*d).most = max((*d).most, abs(diff));
}

fn doubled_feed(d: ptr<function, Doubled>, ray: Ray) {
    if !(*d).is_done {
        var own = ray;
        var st = (*d).state;
        (*d).is_done = technique_segment(&st, &own, (*d).open);
        (*d).state = st;
        (*d).bends = (*d).bends || own.bends > 0u;
    }
    (*d).filled = 0u;
}

fn doubled_segment(d: ptr<function, Doubled>, state: TechniqueState, ray: Ray, segment: Segment, behind: vec4f, first: u32) {
    if (*d).bends || ray.bends > 0u {
        (*d).bends = true;
        return;
    }
    if (*d).filled == 0u {
        doubled_compare(d, state, ray, behind);
        (*d).open = segment;
    } else {
        let o = (*d).open;
        let has_middle = (*d).filled == (*d).stride / 2u && abs(o.length - segment.length * f32((*d).stride / 2u)) < 1e-3 * o.length;
        var middle = o.middle;
        if (*d).filled == (*d).stride / 2u { middle = segment.front.scalar; }
        (*d).open = Segment(o.front, segment.back, o.start, segment.start + segment.length - o.start, middle, has_middle && (*d).stride == 2u);
    }
    (*d).filled += 1u;
    if (*d).filled == (*d).stride || segment.start + segment.length >= ray.far - ray.near || first == 1u {
        doubled_feed(d, ray);
    }
}

fn error_layer_segment(walk: ptr<function, ErrorLayer>, state: TechniqueState, ray: Ray, segment: Segment) {
    if segment.start == 0.0 { (*walk).index = 0u; }
    (*walk).index += 1u;
    var a = (*walk).a;
    doubled_segment(&a, state, ray, segment, (*walk).behind, 0u);
    (*walk).a = a;
    var b = (*walk).b;
    doubled_segment(&b, state, ray, segment, (*walk).behind, (*walk).index);
    (*walk).b = b;
    var c = (*walk).c;
    doubled_segment(&c, state, ray, segment, (*walk).behind, 0u);
    (*walk).c = c;
}

fn doubled_finish(d: ptr<function, Doubled>, state: TechniqueState, ray: Ray, behind: vec4f, given: u32, pixel: vec2f) {
    if (*d).bends || ray.bends > 0u {
        let other = error_layer_walk(pixel, (*d).stride);
        var diff = technique_finish(state, ray).color;
        diff += select(1.0 - diff.w, 0.0, ray.bends > 0u) * behind;
        (*d).difference = diff - other;
        (*d).most = abs((*d).difference);
        (*d).sum = (*d).most;
        (*d).squares = (*d).most * (*d).most;
        return;
    }
    var index = given;
    for (var turn = 0u; turn < 4u && (*d).filled != 0u; turn++) {
        let o = (*d).open;
        let end = traverse_segment_end(ray, index);
        let back = sample_along(ray, end);
        let start = o.start + o.length;
        index += 1u;
        var segment = segment_between(Sample(vec3f(0.0), o.back.scalar), back, start, end - start);
        doubled_segment(d, state, ray, segment, behind, 0u);
    }
    doubled_compare(d, state, ray, behind);
}

fn largest(v: vec4f) -> f32 { let a = abs(v); return max(max(a.x, a.y), max(a.z, a.w)); }

fn error_layer_finish(walk: ptr<function, ErrorLayer>, state: TechniqueState, ray: Ray, is_done: bool) -> f32 {
    var a = (*walk).a;
    doubled_finish(&a, state, ray, (*walk).behind, (*walk).index, (*walk).pixel);
    var b = (*walk).b;
    doubled_finish(&b, state, ray, (*walk).behind, (*walk).index, (*walk).pixel);
    var c = (*walk).c;
    doubled_finish(&c, state, ray, (*walk).behind, (*walk).index, (*walk).pixel);
    let rest = select(0.0, 1.0 - technique_finish(state, ray).color.w, is_done);
    switch params.error_candidate {
        case 0u: { return largest(a.difference); }
        case 1u: { return largest(sqrt(a.squares)); }
        case 2u: { return largest(a.sum); }
        case 3u: { return largest(a.most); }
        case 4u: { return largest(b.difference); }
        case 5u: { return largest(sqrt(b.squares)); }
        case 6u: { return largest(b.sum); }
        case 7u: { return largest(c.difference); }
        case 8u: { return largest(sqrt(c.squares)); }
        default: { return rest; }
    }
}

// The colour of a walk of its own.
fn error_layer_walk(pixel: vec2f, stride: u32) -> vec4f {
    labels_select(STRETCH_NO_LABEL);
    var ray = volume_clip_ray(ray_through(pixel));
    var parts = parts_begin(ray);
    var state = technique_begin(ray);
    var is_done = false;
    for (var part = 0u; !is_done && part < 65535u; part++) {
        if !parts_next(&parts, &ray) {
            break;
        }
        let length = ray.far - ray.near;
        var front = sample_along(ray, 0.0);
        var start = 0.0;
        for (var index = stride - 1u; start < length && index < 65535u; index += stride) {
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
    let color = technique_finish(state, ray).color;
    return color + select(1.0 - color.w, 0.0, ray.bends > 0u) * behind_color(vec2i(pixel));
}

fn error_layer(shown: Shown, pixel: vec2i) {
    textureStore(error_out, pixel, vec4f(shown.error));
}
