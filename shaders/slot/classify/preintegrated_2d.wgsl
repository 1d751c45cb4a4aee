// Colour and opacity of a segment: the integral of the transfer function over a scalar that runs linearly from
// front to back, from a table (Engel, Kraus and Ertl 2001), attenuation inside the segment included. Order 2 in
// the step, for any transfer function; right at large steps where the transfer function has narrow peaks.
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let front = segment.front.scalar;
    let back = segment.back.scalar;
    // A double one is two of the table's: the scalar runs linearly through both. A loop, for software drivers run both
    // sides of an `if`.
    let count = select(1u, 2u, segment.length >= 1.5 * transfer.preintegration_length);
    let length = segment.length / f32(count);
    let change = (back - front) / f32(count);
    var all = Classified(vec3f(0.0), 1.0);
    for (var turn = 0u; turn < count; turn++) {
        let from_scalar = front + f32(turn) * change;
        let to_scalar = select(from_scalar + change, back, turn + 1u == count);
        let piece = preintegrated_2d_piece(from_scalar, to_scalar, length);
        all = Classified(all.color + all.transmittance * piece.color, all.transmittance * piece.transmittance);
    }
    return all;
}

// Between two scalars, over a world length.
fn preintegrated_2d_piece(front: f32, back: f32, length: f32) -> Classified {
    let entry = transfer_between(front, back);
    let transmittance = exp(-entry.w);
    // The table is made for segments of one length. The last one is shorter: its optical depth is in proportion, and
    // its colour is that of the whole segment seen through the shorter depth. So with a longer one.
    let part = length / transfer.preintegration_length;
    if abs(part - 1.0) < 1.0e-4 {
        return Classified(entry.xyz, transmittance);
    }
    let part_transmittance = exp(-entry.w * part);
    let whole_opacity = 1.0 - transmittance;
    let ratio = select(part, (1.0 - part_transmittance) / whole_opacity, whole_opacity > 1.0e-4);
    return Classified(entry.xyz * ratio, part_transmittance);
}
