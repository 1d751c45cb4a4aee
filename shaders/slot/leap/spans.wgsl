// Where is the next segment that may be seen? In the next span that a scout has found for the ray's tile of pixels: so
// rays go side by side, and none of them looks at bricks.
#import "lib/leap.wgsl"
#import "lib/nearest_sampler.wgsl"
#import "lib/ray.wgsl"
#import "lib/spans.wgsl"
#import "lib/step.wgsl"

@group(1) @binding(36) var spans: texture_2d<f32>;

// A span of a tile. They rise, and behind the last one there are none.
fn spans_span(tile: vec2f, number: u32) -> vec2f {
    let place = (spans_texel(tile, number / 2u) + 0.5) * (1.0 / spans_size());
    let pair = textureSampleLevel(spans, nearest_sampler, place, 0.0);
    return select(pair.zw, pair.xy, number % 2u == 0u);
}

// Looks are at one span each. (Parts of a ray that are cut off start behind some of them; to count those first costs more.)
fn leap_from(ray: Ray, index: u32, look: u32) -> Leap {
    let is_last = look >= 2u * SPANS_TEXELS;
    var span = spans_span(spans_tile(ray.pixel), min(look, 2u * SPANS_TEXELS - 1u));
    span = select(vec2f(0.0, 3.0e38), span, spans_are_known());
    let whole = u32((ray.far - ray.near) / step_world());
    // A little more on either side: distances are rounded.
    let per_step = 1.0 / step_world();
    let rounding = 0.01 + 1.0e-6 * span.y * per_step;
    let begin = clamp((span.x - ray.near) * per_step - rounding, 0.0, f32(whole));
    // The walk ends where it has counted the last whole step, perhaps another one than here.
    let last = u32(clamp((span.y - ray.near) * per_step + 1.0 + rounding, 0.0, f32(whole + 2u)));
    // Behind the last span nothing of the ray is left to see.
    let at = max(index, select(u32(begin) & ~1u, (whole & ~1u) + 2u, is_last || span.y < 0.0));
    return Leap(at, (max(last, at + 1u) - at + 1u) & ~1u, 1u);
}
