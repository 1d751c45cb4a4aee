// Estimated integration error of the colour. Nobody reads it.
#import "lib/shown.wgsl"
#import slot "technique"

struct ErrorLayer {
    nothing: u32,
}

fn error_layer_begin(ray: Ray, pixel: vec2f) -> ErrorLayer {
    return ErrorLayer(0u);
}

fn error_layer_segment(walk: ptr<function, ErrorLayer>, state: TechniqueState, ray: Ray, segment: Segment) {
}

fn error_layer_finish(walk: ptr<function, ErrorLayer>, state: TechniqueState, ray: Ray, is_done: bool) -> f32 {
    return 0.0;
}

fn error_layer(shown: Shown, pixel: vec2i) {
}
