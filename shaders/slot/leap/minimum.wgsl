// Where is the next segment that may be seen? In the next brick that can lower the smallest scalar that the ray has met.
#import "lib/brick_leap.wgsl"
#import "lib/brick_ranges.wgsl"
#import "lib/extremum.wgsl"

fn leap_from(ray: Ray, index: u32) -> Leap {
    let length = ray.far - ray.near;
    var at = index;
    for (var turn = 0u; turn < BRICK_LEAP_TURNS; turn++) {
        if f32(at) * step_world() >= length {
            break;
        }
        let place = brick_leap_place(ray, at);
        let brick = bricks_at(place);
        let next = brick_leap_through(ray, at, place, brick, brick + 1);
        if -brick_range(brick).x > extremum_reached {
            return brick_leap_to(index, at, next);
        }
        if next == at {
            break;
        }
        at = next;
    }
    return brick_leap_to(index, at, at);
}
