// The walk along one pixel's ray, segment by segment. Nobody reads it.
#import "lib/shown.wgsl"
#import slot "technique"

fn trace_layer_begin(whole: Ray, pixel: vec2f) {
}

fn trace_layer_part(ray: Ray) {
}

fn trace_layer_leap(start: f32, end: f32) {
}

fn trace_layer_segment(state: TechniqueState, ray: Ray, segment: Segment, is_done: bool) {
}

fn trace_layer(shown: Shown, pixel: vec2i) {
}
