// Colour and opacity of a segment: pre-integrated without attenuation inside of the segment (Engel, Kraus and Ertl 2001,
// equation 8), for tests of order 1. The colour may be brighter than the opacity allows.
// @order 1
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let mean = transfer_mean(segment.front.scalar, segment.back.scalar);
    // A halving is a depth of ln 2.
    let depth = segment.length * transfer.halvings_per_world * 0.69314718;
    return Classified(mean.xyz * depth, exp(-mean.w * depth));
}
