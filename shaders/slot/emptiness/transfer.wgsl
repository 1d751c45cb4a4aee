// Of which scalars is nothing seen? Of those that the transfer function makes absorb nothing.
#import "lib/absorbing.wgsl"

fn emptiness_is_seen(low: f32, high: f32) -> bool {
    return absorbing_between(low, high);
}
