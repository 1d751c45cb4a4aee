// The nearest entry of a table over the scalars at a segment's two ends.
#import "lib/nearest_sampler.wgsl"

// Of a texture that is one table, as wide as high. The sampler clamps.
fn nearest_entry(entries: texture_2d<f32>, place: vec2f, last: f32) -> vec4f {
    // The factor is the same for all lookups: a division is not.
    let texel = clamp(place, vec2f(0.0), vec2f(last)) + 0.5;
    return textureSampleLevel(entries, nearest_sampler, texel * (1.0 / (last + 1.0)), 0.0);
}
