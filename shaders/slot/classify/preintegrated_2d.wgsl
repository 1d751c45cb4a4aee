// Colour and opacity of a segment: the integral of the transfer function over a scalar that runs linearly from
// front to back, from a table (Engel, Kraus and Ertl 2001), attenuation inside the segment included. Order 2 in
// the step, for any transfer function; right at large steps where the transfer function has narrow peaks.
// @order 2
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let entry = transfer_between(segment.front.scalar, segment.back.scalar);
    let transmittance = exp(-entry.w);
    // The table is made for segments of one length. The last one is shorter: its optical depth is in proportion, and
    // its colour is that of the whole segment seen through the shorter depth. So with a longer one.
    let part = segment.length / transfer.preintegration_length;
    if abs(part - 1.0) < 1.0e-4 {
        return Classified(entry.xyz, transmittance);
    }
    let part_transmittance = exp(-entry.w * part);
    let whole_opacity = 1.0 - transmittance;
    let ratio = select(part, (1.0 - part_transmittance) / whole_opacity, whole_opacity > 1.0e-4);
    return Classified(entry.xyz * ratio, part_transmittance);
}
