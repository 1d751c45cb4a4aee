// Where is the next segment that may be seen? In the next span that a scout has found for the ray's tile of pixels: so
// rays go side by side, and none of them looks at bricks.
#import "lib/leap.wgsl"
#import "lib/nearest_sampler.wgsl"
#import "lib/ray.wgsl"
#import "lib/spans.wgsl"
#import "lib/step.wgsl"

@group(1) @binding(36) var spans: texture_2d<f32>;

fn leap_from(ray: Ray, index: u32) -> Leap {
    let tiles = spans_tiles();
    if any(tiles < vec2f(1.0)) {
        return Leap(index, 65535u, 1u);
    }
    let tile = min(floor(ray.pixel / spans_pixels()), tiles - 1.0);
    let per_texel = 1.0 / max(floor(lens.extent * 0.5 + 0.5), vec2f(1.0));
    let start = ray.near + f32(index) * step_world();
    var pair = vec4f(SPANS_NONE, SPANS_NONE);
    var is_searching = true;
    for (var number = 0u; number < SPANS_TEXELS && is_searching; number++) {
        pair = textureSampleLevel(spans, nearest_sampler, (spans_texel(tile, number) + 0.5) * per_texel, 0.0);
        // Where there is none more, the second one of a pair is none.
        is_searching = pair.y <= start && pair.w <= start && pair.w > 0.0;
    }
    let span = select(pair.zw, pair.xy, pair.y > start);
    let length = ray.far - ray.near;
    let whole = u32(length / step_world());
    // A little more on either side: distances are rounded.
    let begin = clamp((span.x - ray.near) / step_world() - 0.01, 0.0, f32(whole));
    let end = clamp((span.y - ray.near) / step_world() + 1.01, 0.0, f32(whole));
    // Behind the last span nothing of the ray is left to see.
    let next = select(u32(begin), whole + 2u, span.y <= start);
    // A leap goes to an even segment, so that segments keep their partners.
    let first = max(index, next & ~1u);
    return Leap(first, max((max(u32(end), first) - first + 1u) & ~1u, 2u), 1u);
}
