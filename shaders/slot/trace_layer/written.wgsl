// The walk along one pixel's ray, segment by segment: what was taken, what was leapt over, and what the technique would
// show if the walk ended there. Read back by `ray` of the engine, which knows this layout.
//
// Texels run along rows. Four of them tell of the ray: (records, entry, exit, `skipped`), its colour, what is behind,
// (depth, bends, samples, 0). Then each record has three: (start, length, front scalar, back scalar), the colour so far,
// (what it is, whether the walk is done, label, bends). Distances of records count from the ray's entry into the box.
#import "lib/shown.wgsl"
#import slot "behind"
#import slot "labels"
#import slot "technique"

struct Params {
    /// The pixel whose ray is written down: column and row, from the top left. @default 0 0 @range 0 65535
    trace_pixel: vec2u,
}

@group(0) @binding(12) var trace_out: texture_storage_2d<rgba32float, write>;

const TRACE_LAYER_WIDTH: u32 = 1024u;
const TRACE_LAYER_HEAD: u32 = 4u;
const TRACE_LAYER_RECORD: u32 = 3u;
const TRACE_LAYER_RECORDS: u32 = 65534u;
const TRACE_LAYER_TAKEN: f32 = 0.0;
const TRACE_LAYER_LEAP: f32 = 1.0;

var<private> trace_layer_is_on: bool;
var<private> trace_layer_records: u32;
// World distances from the ray's origin: of the box's entry and exit, and of the part's entry.
var<private> trace_layer_entry: f32;
var<private> trace_layer_exit: f32;
var<private> trace_layer_near: f32;
var<private> trace_layer_label: u32;
// The colour so far.
var<private> trace_layer_color: vec4f;

fn trace_layer_begin(whole: Ray, pixel: vec2f) {
    trace_layer_is_on = all(vec2u(pixel) == params.trace_pixel);
    trace_layer_records = 0u;
    trace_layer_entry = whole.near;
    trace_layer_exit = whole.far;
    trace_layer_near = whole.near;
    trace_layer_label = 0u;
    trace_layer_color = vec4f(0.0);
}

fn trace_layer_part(ray: Ray) {
    trace_layer_near = ray.near;
    trace_layer_label = ray.label;
}

// A leap between two world distances from the part's entry.
fn trace_layer_leap(start: f32, end: f32) {
    if trace_layer_is_on && end > start {
        let place = vec4f(trace_layer_near - trace_layer_entry + start, end - start, 0.0, 0.0);
        trace_layer_record(place, vec4f(TRACE_LAYER_LEAP, 0.0, f32(trace_layer_label), 0.0));
    }
}

// A segment that was walked through, `state` and `ray` being what they are after it.
fn trace_layer_segment(state: TechniqueState, ray: Ray, segment: Segment, is_done: bool) {
    if !trace_layer_is_on {
        return;
    }
    // Techniques may select labels in the end.
    let label = labels_selected();
    trace_layer_color = technique_finish(state, ray).color;
    labels_select(label);
    let start = trace_layer_near - trace_layer_entry + segment.start;
    let place = vec4f(start, segment.length, segment.front.scalar, segment.back.scalar);
    let done = select(0.0, 1.0, is_done);
    trace_layer_record(place, vec4f(TRACE_LAYER_TAKEN, done, f32(trace_layer_label), f32(ray.bends)));
}

fn trace_layer_record(place: vec4f, what: vec4f) {
    if trace_layer_records < TRACE_LAYER_RECORDS {
        let at = TRACE_LAYER_HEAD + TRACE_LAYER_RECORD * trace_layer_records;
        trace_layer_write(at, place);
        trace_layer_write(at + 1u, trace_layer_color);
        trace_layer_write(at + 2u, what);
    }
    trace_layer_records++;
}

fn trace_layer_write(texel: u32, value: vec4f) {
    textureStore(trace_out, vec2u(texel % TRACE_LAYER_WIDTH, texel / TRACE_LAYER_WIDTH), value);
}

fn trace_layer(shown: Shown, pixel: vec2i) {
    if any(vec2u(pixel) != params.trace_pixel) {
        return;
    }
    let records = f32(trace_layer_records);
    trace_layer_write(0u, vec4f(records, trace_layer_entry, trace_layer_exit, shown.ray.skipped));
    trace_layer_write(1u, shown.result.color);
    trace_layer_write(2u, behind_color(pixel));
    trace_layer_write(3u, vec4f(shown.result.depth, f32(shown.ray.bends), f32(shown.samples), 0.0));
}
