// What is between the entries of a table over the scalars at a segment's two ends? Bilinear from four loads, for devices that
// cannot filter single floats.

// Bilinear between entries: `place` counts entries from front (x) and back (y), up to `last`. Of several tables in one
// texture, `first` is the first entry of the one that is read.
fn between_entries(entries: texture_2d<f32>, place: vec2f, last: f32, first: vec2i) -> vec4f {
    let inside = clamp(place, vec2f(0.0), vec2f(last));
    let low = min(floor(inside), vec2f(last - 1.0));
    let part = inside - low;
    let at = vec2i(low) + first;
    let near = mix(textureLoad(entries, at, 0), textureLoad(entries, at + vec2i(1, 0), 0), part.x);
    let far = mix(textureLoad(entries, at + vec2i(0, 1), 0), textureLoad(entries, at + vec2i(1, 1), 0), part.x);
    return mix(near, far, part.y);
}

// The same of a texture that is one table, as wide as high.
fn between_all_entries(entries: texture_2d<f32>, place: vec2f, last: f32) -> vec4f {
    return between_entries(entries, place, last, vec2i(0));
}
