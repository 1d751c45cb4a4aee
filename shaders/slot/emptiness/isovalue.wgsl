// Of which scalars is nothing seen? Of those outside of the solid that the isosurface bounds.
#import "lib/isovalue.wgsl"

fn emptiness_is_seen(low: f32, high: f32) -> bool {
    return isovalue_is_solid(low) || isovalue_is_solid(high) || low == isovalue_level();
}
