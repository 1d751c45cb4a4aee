// Which segments does the technique look into? All, as the walk comes by.
#import "lib/ray.wgsl"

// How often a ray is walked along.
fn heed_walks() -> u32 {
    return 1u;
}

fn heed_begin(walk: u32) {
}

// Whether the technique sees only what is heeded, outside of the walk's innermost loop.
fn heed_is_choosy() -> bool {
    return false;
}

// Whether the technique looks into a segment.
fn heed_segment(ray: Ray, segment: Segment) -> bool {
    return true;
}
