// The background: a pattern over the whole picture. It depends on the lens alone, so a moving camera leaves it be.
#import "lib/frame.wgsl"
#import slot "pattern"

@vertex
fn background_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return frame_full_screen(index);
}

@fragment
fn background_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return pattern_color(frame_view_plane(position.xy));
}
