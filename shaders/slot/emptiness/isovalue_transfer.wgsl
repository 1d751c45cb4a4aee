// Of which scalars is nothing seen? Of those outside of the solid that the transfer function makes absorb nothing.
#import "lib/absorbing.wgsl"
#import "lib/isovalue.wgsl"

fn emptiness_is_seen(low: f32, high: f32) -> bool {
    let is_solid = isovalue_is_solid(low) || isovalue_is_solid(high) || low == isovalue_level();
    return is_solid || absorbing_between(low, high);
}
