// What is between the entries of a table over the scalars at a segment's two ends? Bilinear, by the device's own filter. Some
// devices weigh with 8 bits of fraction: off by a 512th of what neighbouring entries differ by.
#import "lib/volume_texture.wgsl"

// See `table_filter/loads.wgsl`: of one table in a texture of several, no entry of another is read.
fn between_entries(entries: texture_2d<f32>, place: vec2f, last: f32, first: vec2i) -> vec4f {
    let texel = clamp(place, vec2f(0.0), vec2f(last)) + vec2f(first) + 0.5;
    return textureSampleLevel(entries, linear_sampler, texel / vec2f(textureDimensions(entries)), 0.0);
}

// The same of a texture that is one table, as wide as high: its size is known without asking the device, which costs
// software ones as much as a few texels.
fn between_all_entries(entries: texture_2d<f32>, place: vec2f, last: f32) -> vec4f {
    let texel = clamp(place, vec2f(0.0), vec2f(last)) + 0.5;
    return textureSampleLevel(entries, linear_sampler, texel * (1.0 / (last + 1.0)), 0.0);
}
