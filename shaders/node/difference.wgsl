// How one picture differs from another: as a picture, and as a number for each pixel.
#import "lib/frame.wgsl"

struct Params {
    /// What differences are multiplied by in the picture. @default 1 @range 0 1000000
    amplification: f32,
    /// `absolute` shows how large differences are; `signed` adds them to middle gray. @default absolute @choices absolute signed
    shown: u32,
}

@group(0) @binding(2) var a: texture_2d<f32>;
@group(0) @binding(3) var b: texture_2d<f32>;
@group(0) @binding(4) var color_out: texture_storage_2d<rgba32float, write>;
@group(0) @binding(5) var error_out: texture_storage_2d<r32float, write>;

fn difference_at(pixel: vec2i) -> vec4f {
    return textureLoad(a, pixel, 0) - textureLoad(b, pixel, 0);
}

@compute @workgroup_size(8, 8, 1)
fn difference_color(@builtin(global_invocation_id) id: vec3u) {
    if any(vec2f(id.xy) >= lens.extent) {
        return;
    }
    let signed = params.amplification * difference_at(vec2i(id.xy)).xyz;
    let color = select(abs(signed), vec3f(0.5) + 0.5 * signed, params.shown == 1u);
    textureStore(color_out, id.xy, vec4f(color, 1.0));
}

@compute @workgroup_size(8, 8, 1)
fn difference_error(@builtin(global_invocation_id) id: vec3u) {
    if any(vec2f(id.xy) >= lens.extent) {
        return;
    }
    let size = abs(difference_at(vec2i(id.xy)));
    textureStore(error_out, id.xy, vec4f(max(max(size.x, size.y), max(size.z, size.w))));
}
