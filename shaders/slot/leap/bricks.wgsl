// Where is the next segment that may be seen? Beyond the bricks around of which nothing is (Zuiderveld et al. 1992): the
// distance map tells how far the next brick is that may be seen, and the ray goes through all before it in one leap. In
// bricks that may be seen it tells how far the next one is that may not, so that dense volumes cost few looks.
#import "lib/brick_leap.wgsl"
#import "lib/nearest_sampler.wgsl"

@group(1) @binding(32) var distance_map: texture_2d<f32>;

fn leap_from(ray: Ray, index: u32) -> Leap {
    let length = ray.far - ray.near;
    var at = index;
    for (var turn = 0u; turn < BRICK_LEAP_TURNS; turn++) {
        if f32(at) * step_world() >= length {
            break;
        }
        let place = brick_leap_place(ray, at);
        let brick = bricks_at(place);
        let word = u32(textureSampleLevel(distance_map, nearest_sampler, bricks_in_map(brick), 0.0).x) >> 12u;
        let away = i32(word & 0x7ffu);
        let next = brick_leap_through(ray, at, place, brick - (away - 1), brick + away);
        if (word & 0x800u) != 0u {
            return brick_leap_to(index, at, next);
        }
        if next == at {
            break;
        }
        at = next;
    }
    return brick_leap_to(index, at, at);
}
