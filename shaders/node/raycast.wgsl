// Single-pass raycasting (Stegmaier et al. 2005): one walk per pixel through the volume's box, segment by segment.
// The walk is here; what a segment means is the technique's. The same walk runs as a fragment shader over the proxy
// geometry and as a compute shader over the pixels that it covers.
#import "lib/volume.wgsl"
#import "lib/proxy.wgsl"
#import slot "parts"
#import "lib/sample.wgsl"
#import "lib/shown.wgsl"
#import slot "traverse"
#import slot "technique"
#import slot "leap"
#import slot "heed"
#import slot "behind"
#import slot "depth_layer"
#import slot "opacity_layer"
#import slot "position_layer"
#import slot "normal_layer"
#import slot "samples_layer"
#import slot "label_layer"
#import slot "error_layer"
#import slot "trace_layer"

@group(0) @binding(3) var color_out: texture_storage_2d<rgba32float, write>;

// Whatever a `traverse` slot says, a walk ends. Software drivers end every loop after as many turns.
const RAYCAST_MAX_SEGMENTS: u32 = 65535u;

fn raycast_pixel(pixel: vec2f) -> Shown {
    labels_select(STRETCH_NO_LABEL);
    let whole = volume_clip_ray(ray_through(pixel));
    var ray = whole;
    var state = technique_begin(ray);
    var error = error_layer_begin(ray, pixel);
    trace_layer_begin(whole, pixel);
    var samples = 0u;
    var is_done = false;
    for (var walk = 0u; walk < heed_walks(); walk++) {
        heed_begin(walk);
        ray = whole;
        var parts = parts_begin(ray);
        for (var part = 0u; !is_done && part < RAYCAST_MAX_SEGMENTS; part++) {
            if !parts_next(&parts, &ray) {
                break;
            }
            trace_layer_part(ray);
            let length = ray.far - ray.near;
            var front: Sample;
            var start = 0.0;
            var index = 0u;
            // Software drivers run what is in no loop of its own for every pixel, needed or not. So a choosy technique looks
            // into segments out here, and the loops below end at those that it heeds.
            var looks = 0u;
            for (var hunt = 0u; hunt < RAYCAST_MAX_SEGMENTS; hunt++) {
                var segment: Segment;
                var is_heeded = false;
                // A bent ray is another ray: its parts are looked for anew.
                for (; looks < RAYCAST_MAX_SEGMENTS && !is_done && !is_heeded && ray.bends == parts.bends; ) {
                    let leap = leap_from(ray, index);
                    if looks == 0u || leap.index != index {
                        let before = start;
                        index = leap.index;
                        start = 0.0;
                        if index > 0u {
                            start = traverse_segment_end(ray, index - 1u);
                        }
                        trace_layer_leap(before, start);
                        if start < length {
                            front = sample_along(ray, start);
                            samples++;
                        }
                    }
                    looks++;
                    if start >= length {
                        break;
                    }
                    for (var turn = 0u; turn < leap.segments && start < length; turn++) {
                        let end = traverse_segment_end(ray, index + leap.stride - 1u);
                        let back = sample_along(ray, end);
                        samples++;
                        segment = segment_between(front, back, start, end - start);
                        error_layer_segment(&error, state, ray, segment);
                        front = back;
                        start = end;
                        index += leap.stride;
                        if heed_is_choosy() {
                            is_heeded = heed_segment(ray, segment);
                            if is_heeded {
                                break;
                            }
                            trace_layer_segment(state, ray, segment, false);
                        } else {
                            is_done = technique_segment(&state, &ray, segment);
                            trace_layer_segment(state, ray, segment, is_done);
                            if is_done || ray.bends != parts.bends {
                                break;
                            }
                        }
                    }
                }
                if !heed_is_choosy() || !is_heeded {
                    break;
                }
                is_done = technique_segment(&state, &ray, segment);
                trace_layer_segment(state, ray, segment, is_done);
                if is_done {
                    break;
                }
            }
        }
    }
    let estimate = error_layer_finish(&error, state, ray, is_done);
    // What is made of all parts together is no label's.
    labels_select(STRETCH_NO_LABEL);
    return Shown(technique_finish(state, ray), ray, samples, estimate);
}

fn raycast_write(shown: Shown, pixel: vec2i) {
    let color = shown.result.color;
    // A bent ray has left its pixel: what is behind it is in its colour already.
    let open_share = select(1.0 - color.w, 0.0, shown.ray.bends > 0u);
    textureStore(color_out, pixel, color + open_share * behind_color(pixel));
    depth_layer(shown, pixel);
    opacity_layer(shown, pixel);
    position_layer(shown, pixel);
    normal_layer(shown, pixel);
    samples_layer(shown, pixel);
    label_layer(shown, pixel);
    error_layer(shown, pixel);
    trace_layer(shown, pixel);
}

// What lies behind, for every pixel; rays then overwrite those that they start from.
@compute @workgroup_size(8, 8, 1)
fn raycast_begin(@builtin(global_invocation_id) id: vec3u) {
    labels_select(STRETCH_NO_LABEL);
    if all(vec2f(id.xy) < lens.extent) {
        raycast_write(shown_nothing(), vec2i(id.xy));
    }
}

@vertex
fn raycast_vertex(@location(0) world: vec3f) -> @builtin(position) vec4f {
    return proxy_clip_from_world(world);
}

@fragment
fn raycast_fragment(@builtin(position) position: vec4f) {
    raycast_write(raycast_pixel(position.xy), vec2i(position.xy));
}

@compute @workgroup_size(8, 8, 1)
fn raycast_compute(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy + tile.first;
    if all(vec2f(pixel) < lens.extent) {
        raycast_write(raycast_pixel(vec2f(pixel) + 0.5), vec2i(pixel));
    }
}
