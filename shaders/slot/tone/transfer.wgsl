// What does a projected scalar look like: what the transfer function makes of it over one reference length.
#import "lib/transfer.wgsl"

// Linear premultiplied colour.
fn tone_color(scalar: f32) -> vec4f {
    let entry = transfer_at(scalar);
    let opacity = 1.0 - exp(-entry.w);
    return vec4f(entry.xyz * opacity, opacity);
}
