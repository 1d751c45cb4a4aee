// Lookups in tables over the scalars at a segment's two ends.

// Bilinear between entries: `place` counts entries from front (x) and back (y), up to `last`. Of several square tables
// below each other, `table` is the number.
fn between_entries(entries: texture_2d<f32>, place: vec2f, last: f32, table: u32) -> vec4f {
    let inside = clamp(place, vec2f(0.0), vec2f(last));
    let low = min(floor(inside), vec2f(last - 1.0));
    let part = inside - low;
    let at = vec2i(low) + vec2i(0, i32(table) * (i32(last) + 1));
    let near = mix(textureLoad(entries, at, 0), textureLoad(entries, at + vec2i(1, 0), 0), part.x);
    let far = mix(textureLoad(entries, at + vec2i(0, 1), 0), textureLoad(entries, at + vec2i(1, 1), 0), part.x);
    return mix(near, far, part.y);
}
