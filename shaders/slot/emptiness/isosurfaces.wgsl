// Of which scalars is nothing seen? Of those that no isosurface lies between.
#import "lib/isosurfaces.wgsl"

fn emptiness_is_seen(low: f32, high: f32) -> bool {
    for (var index = 0u; index < min(params.surfaces, ISOSURFACES_MAX); index++) {
        let level = isosurfaces_at(index).level;
        if low <= level && level <= high {
            return true;
        }
    }
    return false;
}
