// Where is the next segment that may be seen? In the next span that a scout has found for the ray's tile of pixels: so
// rays go side by side, and none of them looks at bricks.
#import "lib/leap.wgsl"
#import "lib/nearest_sampler.wgsl"
#import "lib/ray.wgsl"
#import "lib/spans.wgsl"
#import "lib/step.wgsl"

@group(1) @binding(36) var spans: texture_2d<f32>;

// The first of a texel's spans that ends behind a distance, if one does; or else a span of the texels behind it.
fn spans_first(tile: vec2f, number: u32, distance: f32, behind: vec2f) -> vec2f {
    let place = (spans_texel(tile, number) + 0.5) / spans_size();
    let pair = textureSampleLevel(spans, nearest_sampler, place, 0.0);
    return select(select(behind, pair.zw, pair.w > distance), pair.xy, pair.y > distance);
}

fn leap_from(ray: Ray, index: u32) -> Leap {
    let start = ray.near + f32(index) * step_world();
    let tile = spans_tile(ray.pixel);
    // In straight line: software drivers run a loop's body once more than there are turns. Spans rise, and those that there are
    // not end before all.
    var span = SPANS_NONE;
    span = spans_first(tile, 3u, start, span);
    span = spans_first(tile, 2u, start, span);
    span = spans_first(tile, 1u, start, span);
    span = spans_first(tile, 0u, start, span);
    // Pictures that are smaller than a tile have none.
    let has_tiles = all(spans_tiles() >= vec2f(1.0));
    span = select(vec2f(0.0, 3.0e38), span, has_tiles);
    let whole = u32((ray.far - ray.near) / step_world());
    // A little more on either side: distances are rounded.
    let rounding = 0.01 + 1.0e-6 * span.y / step_world();
    let begin = clamp((span.x - ray.near) / step_world() - rounding, 0.0, f32(whole));
    let last = u32(clamp((span.y - ray.near) / step_world() + 1.0 + rounding, 0.0, f32(whole)));
    // Behind the last span nothing of the ray is left to see.
    let at = max(index, select(u32(begin) & ~1u, (whole & ~1u) + 2u, span.y <= start));
    return Leap(at, (max(last, at + 1u) - at + 1u) & ~1u, 1u);
}
