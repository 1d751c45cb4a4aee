// Where is the next segment that may be seen? Beyond the bricks around of which nothing is (Zuiderveld et al. 1992): a look
// at a brick tells how far all are alike, and the ray goes through all that are not seen in one leap. So it does through
// those that are: dense volumes cost few looks.
#import "lib/brick_leap.wgsl"
#import slot "look"

// So many segments are walked at least between two looks.
const LEAP_BRICKS_LEAST: u32 = 8u;

fn leap_from(ray: Ray, index: u32) -> Leap {
    let length = ray.far - ray.near;
    var at = index;
    for (var turn = 0u; turn < BRICK_LEAP_TURNS; turn++) {
        if f32(at) * step_world() >= length {
            break;
        }
        let place = brick_leap_place(ray, at);
        let brick = bricks_at(place);
        let look = look_at(brick);
        let next = brick_leap_through(ray, at, place, brick - (look.away - 1), brick + look.away);
        if look.is_seen {
            return brick_leap_to(index, at, next, LEAP_BRICKS_LEAST);
        }
        if next == at {
            break;
        }
        at = next;
    }
    return brick_leap_to(index, at, at, LEAP_BRICKS_LEAST);
}
