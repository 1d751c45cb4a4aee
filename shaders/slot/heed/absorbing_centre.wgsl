// Which segments does the technique look into? Those of which anything absorbs at their centres.
#import "lib/absorbing_few.wgsl"
#import "lib/ray.wgsl"
#import slot "reconstruct"

fn heed_walks() -> u32 {
    return 1u;
}

fn heed_begin(walk: u32) {
}

fn heed_is_choosy() -> bool {
    return true;
}

fn heed_segment(ray: Ray, segment: Segment) -> bool {
    let scalar = reconstruct_scalar(segment_centre(ray, segment));
    return absorbing_few_between(scalar, scalar);
}
