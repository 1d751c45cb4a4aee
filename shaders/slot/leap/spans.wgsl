// Where is the next segment that may be seen? In the next span that a scout has found for the ray's tile of pixels: so
// rays go side by side, and none of them looks at bricks. Where a tile is as wide as a brick, spans are far longer than what
// each ray sees: then they are bounds, and within them each ray looks at bricks for itself.
#import "lib/brick_leap.wgsl"
#import "lib/nearest_sampler.wgsl"
#import "lib/spans.wgsl"
#import "lib/spans_beside.wgsl"
#import slot "look"

@group(1) @binding(36) var spans: texture_2d<f32>;

// Bricks between rays of a tile from which on each looks for itself.
const SPANS_COARSE: f32 = 0.6;

fn leap_from(ray: Ray, index: u32) -> Leap {
    let tiles = spans_tiles();
    let tile = spans_tile(ray.pixel);
    let per_texel = 1.0 / spans_size();
    let start = ray.near + f32(index) * step_world();
    // Pictures that are smaller than a tile have none.
    var pair = vec4f(0.0, 3.0e38, SPANS_NONE);
    var is_searching = all(tiles >= vec2f(1.0));
    for (var number = 0u; number < SPANS_TEXELS && is_searching; number++) {
        pair = textureSampleLevel(spans, nearest_sampler, (spans_texel(tile, number) + 0.5) * per_texel, 0.0);
        // Where there is none more, the second one of a pair is none.
        is_searching = pair.y <= start && pair.w <= start && pair.w > 0.0;
    }
    let span = select(pair.zw, pair.xy, pair.y > start);
    let whole = u32((ray.far - ray.near) / step_world());
    // A little more on either side: distances are rounded.
    let rounding = 0.01 + 1.0e-6 * span.y / step_world();
    let begin = clamp((span.x - ray.near) / step_world() - rounding, 0.0, f32(whole));
    let last = u32(clamp((span.y - ray.near) / step_world() + 1.0 + rounding, 0.0, f32(whole)));
    // Behind the last span nothing of the ray is left to see.
    let is_over = span.y <= start;
    var at = max(index, select(u32(begin), whole + 2u, is_over));
    var end = max(last, at);
    let beside = spans_beside(ray);
    let is_coarse = max(max(beside.x, beside.y), beside.z) > SPANS_COARSE;
    is_searching = is_coarse && at < last && !is_over;
    var is_seen = !is_searching;
    for (var turn = 0u; turn < BRICK_LEAP_TURNS && is_searching; turn++) {
        let place = brick_leap_place(ray, at);
        let look = look_at(bricks_at(place));
        end = min(brick_leap_through(ray, at, place, look.low, look.high), last);
        is_seen = look.is_seen || end == at;
        is_searching = !is_seen && end < last;
        at = select(end, at, look.is_seen);
    }
    return brick_leap_to(index, at, end, select(2u, look_least(), is_coarse && is_seen));
}
