// Which parts of the ray are seen? All of it, as one part: nothing is clipped, and there are no labels.
#import "lib/volume.wgsl"
#import slot "labels"

struct Parts {
    // How often the ray had changed its direction.
    bends: u32,
    is_begun: bool,
}

// Most parts of a ray that is not bent.
const PARTS_MAX: u32 = 1u;

fn parts_begin(ray: Ray) -> Parts {
    return Parts(ray.bends, false);
}

// True for a ray as it is, once, and again where it has been bent.
fn parts_next(parts: ptr<function, Parts>, ray: ptr<function, Ray>) -> bool {
    let is_new = !(*parts).is_begun || (*ray).bends != (*parts).bends;
    *parts = Parts((*ray).bends, true);
    (*ray).visible_end = (*ray).far;
    return is_new && (*ray).far - (*ray).near > volume_least();
}

// Whether more of a ray is visible right behind a distance from its entry.
fn parts_go_on(ray: Ray, distance: f32) -> bool {
    return volume_exit(ray_position(ray, distance), ray.slope) > volume_least();
}
