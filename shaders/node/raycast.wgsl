// Single-pass raycasting (Stegmaier et al. 2005): one walk per pixel through the volume's box, segment by segment.
// The walk is here; what a segment means is the technique's. The same walk runs as a fragment shader over the proxy
// geometry and as a compute shader over the pixels that it covers, or those of them that are worth it.
#import "lib/volume.wgsl"
#import "lib/proxy.wgsl"
#import slot "parts"
#import "lib/sample.wgsl"
#import "lib/shown.wgsl"
#import slot "pixels"
#import slot "technique"
#import slot "walk"
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
        for (var part = 0u; !is_done && part < WALK_MAX_SEGMENTS; part++) {
            if !parts_next(&parts, &ray) {
                break;
            }
            trace_layer_part(ray);
            let walked = walk_part(&state, &ray, &error);
            samples += walked.samples;
            is_done = walked.is_done;
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
fn raycast_compute(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixel = pixels_at(group, lane);
    if all(vec2f(pixel) < lens.extent) {
        raycast_write(raycast_pixel(vec2f(pixel) + 0.5), vec2i(pixel));
    }
}
