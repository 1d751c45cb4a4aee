// A layer of numbers in the colours of a transfer function.
#import "lib/frame.wgsl"
#import slot "legend"

struct Params {
    /// The number that takes the transfer function's first colour. @default 0
    low: f32,
    /// The number that takes its last colour. @default 1
    high: f32,
    /// How the numbers between them take the colours between: evenly, or each ratio alike.
    /// @default linear @choices linear logarithmic
    scale: u32,
}

@group(0) @binding(2) var layer: texture_2d<f32>;
@group(0) @binding(3) var color_out: texture_storage_2d<rgba32float, write>;
@group(2) @binding(1) var transfer_table: texture_2d<f32>;

@compute @workgroup_size(8, 8, 1)
fn false_color_compute(@builtin(global_invocation_id) id: vec3u) {
    if any(vec2f(id.xy) >= lens.extent) {
        return;
    }
    let number = textureLoad(layer, vec2i(id.xy), 0).x;
    let low = false_color_place(params.low);
    let span = false_color_place(params.high) - low;
    let share = (false_color_place(number) - low) / select(span, 1.0e-30, span == 0.0);
    let last = i32(textureDimensions(transfer_table).x) - 1;
    let entry = textureLoad(transfer_table, vec2i(i32(clamp(share, 0.0, 1.0) * f32(last) + 0.5), 0), 0);
    let drawn = legend_color(vec2i(id.xy) + vec2i(lens.corner));
    textureStore(color_out, id.xy, vec4f(drawn.xyz + (1.0 - drawn.w) * entry.xyz, 1.0));
}

// Where a number is on the scale.
fn false_color_place(number: f32) -> f32 {
    if params.scale == 1u {
        return log2(max(number, 1.0e-37));
    }
    return number;
}
