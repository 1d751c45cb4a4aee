// Colour and opacity of a segment: the transfer function at the segment's start, for tests of order 1.
// @order 1
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let entry = transfer_at(segment.front.scalar);
    let transmittance = exp2(-entry.w * (segment.length * transfer.halvings_per_world));
    return Classified(entry.xyz * (1.0 - transmittance), transmittance);
}
