// Where is the next segment that may be seen, and how long may it be? A look at a brick tells how far around all are alike
// (Zuiderveld et al. 1992): the ray goes through all that are not seen in one leap. So it does through those that are:
// dense volumes cost few looks.
#import "lib/brick_leap.wgsl"
#import "lib/step.wgsl"
#import slot "look"

fn leap_from(ray: Ray, index: u32, look: u32) -> Leap {
    let length = ray.far - ray.near;
    var at = index;
    var end = index;
    var power = 0u;
    var is_searching = f32(at) * step_world() < length;
    // One way out: see `walk/pairs.wgsl`.
    for (var turn = 0u; turn < BRICK_LEAP_TURNS && is_searching; turn++) {
        let place = brick_leap_place(ray, at, step_world());
        let look = look_at(bricks_at(place));
        end = brick_leap_through(ray, at, step_world(), place, look.low, look.high);
        power = look.power;
        is_searching = !look.is_seen && end != at && f32(end) * step_world() < length;
        at = select(end, at, look.is_seen);
    }
    let leap = brick_leap_to(index, at, end, look_least());
    let room = max(end, leap.index) - leap.index;
    let stride = min(1u << power, 1u << firstLeadingBit(max(room / look_least(), 1u)));
    return Leap(leap.index, select((room / stride) & ~1u, leap.segments, stride == 1u), stride);
}
