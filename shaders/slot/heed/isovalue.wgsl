// Which segments does the technique look into? Those that the isosurface may cross, and the ends of parts. Where only what
// lies between the samples can cross, it has to rise or fall that far there, and back.
#import "lib/crossing.wgsl"
#import "lib/isovalue.wgsl"
#import "lib/steepness.wgsl"

fn heed_walks() -> u32 {
    return 1u;
}

fn heed_begin(walk: u32) {
}

fn heed_is_choosy() -> bool {
    return true;
}

fn heed_segment(ray: Ray, segment: Segment) -> bool {
    let end = segment.start + segment.length;
    let is_end = segment.start == 0.0 || end + volume_least() >= ray.far - ray.near;
    let front = segment.front.scalar - isovalue_level();
    let back = segment.back.scalar - isovalue_level();
    let is_crossed = (front >= 0.0) != (back >= 0.0);
    // Without `cubic` only what the samples tell is seen.
    let reach = select(-1.0, steepness_within(ray, segment) + 2.0 * steepness.error, params.refinement == 3u);
    return is_end || is_crossed || abs(front) + abs(back) <= reach;
}
