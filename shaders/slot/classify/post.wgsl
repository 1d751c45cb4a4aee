// Colour and opacity of a segment: the transfer function at the scalar of the segment's centre (midpoint rule).
// Order of convergence 2 in the step for smooth transfer functions.
// @order 2
#import "lib/classified.wgsl"
#import "lib/stretch_of_one.wgsl"
#import slot "reconstruct"
#import slot "steps"

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    var scalar = segment.middle;
    if !segment.has_middle {
        scalar = reconstruct_scalar(segment_centre(ray, segment));
    }
    if segment.is_step {
        return steps_at(scalar, segment.length);
    }
    return stretch_of_one(scalar, segment.length);
}
