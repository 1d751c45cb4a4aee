// Colour and opacity of a segment: the mean of the transfer function at its two ends (trapezoid rule), made denser or
// thinner by a factor.
//
// A classification says what emission and absorption make of a segment. The technique asks it for each segment.
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"

struct Params {
    /// Factor on the extinction. @default 1 @range 0 100
    density: f32,
}

// The colour is premultiplied: what the segment sends to the eye. The transmittance is the share of the light behind
// that passes. Segments differ in length, so the extinction is multiplied with it.
fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let front = transfer_at(segment.front.scalar);
    let back = transfer_at(segment.back.scalar);
    let extinction = 0.5 * (front.w + back.w);
    // The mean colour, each end weighted with its own extinction.
    let color = (front.xyz * front.w + back.xyz * back.w) / max(front.w + back.w, 1.0e-12);
    let halvings = params.density * extinction * transfer.halvings_per_world * segment.length;
    let transmittance = exp2(-halvings);
    return Classified(color * (1.0 - transmittance), transmittance);
}
