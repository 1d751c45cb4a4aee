// Colour and opacity of a segment: the transfer function at the scalar of the segment's centre (midpoint rule).
// Order of convergence 2 in the step for smooth transfer functions.
// @order 2
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"
#import slot "reconstruct"

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    var scalar = segment.middle;
    if !segment.has_middle {
        scalar = reconstruct_scalar(segment_centre(ray, segment));
    }
    let entry = transfer_at(scalar);
    let transmittance = exp2(-entry.w * (segment.length * transfer.halvings_per_world));
    return Classified(entry.xyz * (1.0 - transmittance), transmittance);
}
