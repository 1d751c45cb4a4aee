// The background: a pattern over the whole picture. It depends on the lens alone, so a moving camera leaves it be.
#import "lib/frame.wgsl"
#import slot "pattern"

@group(0) @binding(3) var color_out: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn background_compute(@builtin(global_invocation_id) id: vec3u) {
    if any(vec2f(id.xy) >= lens.extent) {
        return;
    }
    textureStore(color_out, id.xy, pattern_color(frame_view_plane(vec2f(id.xy) + 0.5)));
}
