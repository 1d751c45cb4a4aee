// Which segments does the technique look into? Those of which anything absorbs between the scalars at their ends.
#import "lib/absorbing_few.wgsl"
#import "lib/ray.wgsl"

fn heed_walks() -> u32 {
    return 1u;
}

fn heed_begin(walk: u32) {
}

fn heed_is_choosy() -> bool {
    return true;
}

fn heed_segment(ray: Ray, segment: Segment) -> bool {
    let front = segment.front.scalar;
    let back = segment.back.scalar;
    return absorbing_few_between(min(front, back), max(front, back));
}
