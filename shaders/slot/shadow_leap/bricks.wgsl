// Where does a light's ray go on? Behind the box of bricks around it, where the eye sees nothing of them and so light does not
// either. A look is one box: rays to a light go apart from each other, and software drivers would have all of a vector wait for
// the one that looks most often.
#import "lib/brick_leap.wgsl"
#import slot "look"

// So many segments are walked between two looks.
fn shadow_leap_least() -> u32 {
    return 16u;
}

// The number of the next segment that may matter to a walk that has come to `index`, in steps of a world length.
fn shadow_leap_from(ray: Ray, index: u32, step: f32) -> u32 {
    let place = brick_leap_place(ray, index, step);
    let look = look_at(bricks_at(place));
    let end = brick_leap_through(ray, index, step, place, look.low, look.high);
    return select(end, index, look.is_seen);
}
