// Colour and opacity of a segment: the integral of the transfer function over a scalar that runs linearly from
// front to back, from a table (Engel, Kraus and Ertl 2001), attenuation inside the segment included. Order 2 in
// the step, for any transfer function; right at large steps where the transfer function has narrow peaks.
// @order 2 where lookup=bilinear
// @order 0 where lookup=nearest
//
// Entries are exact to 1e-6; between them the table is bilinear. Of 512 entries a side and segments of one reference
// length that is off by 1e-6 in the mean square for smooth transfer functions (1e-5 of colour maps; worst 1e-3, where a
// ramp begins), by 1e-3 across steps and peaks narrower than an entry, and there, in segments that cover less than an
// entry, by as much as the step shows: 0.5. Twice the entries have a quarter of the former and half of the latter. Mean
// colour and depth between entries, or colour weighted by depth, are no better: between 0.6 and 1.6 times that.
#import "lib/classified.wgsl"
#import "lib/transfer.wgsl"

struct Params {
    /// What is looked up between the entries of the table: `bilinear`, or the `nearest` one, as if scalars were rounded to
    /// as many values as a side has entries. The walk still goes from each value to the next, so that nothing is missed.
    /// @default bilinear @choices bilinear nearest
    lookup: u32,
}

fn preintegrated_2d_entry(place: vec2f) -> vec4f {
    if params.lookup == 1u {
        return transfer_nearest_entry(place);
    }
    return transfer_entries(place);
}

// How much light a whole segment lets through, and its depth: the nearest entry has the one, so that no segment needs an
// exponential of its own; what is between entries is the other, for transmittances bend more from entry to entry.
fn preintegrated_2d_transmittance(entry: vec4f) -> f32 {
    if params.lookup == 1u {
        return entry.w;
    }
    return exp(-entry.w);
}

fn preintegrated_2d_depth(entry: vec4f) -> f32 {
    if params.lookup == 1u {
        return transfer_depth(entry.w);
    }
    return entry.w;
}

// The table is made for segments of one length. The last one is shorter: its optical depth is in proportion, and its
// colour is that of the whole segment seen through the shorter depth. So with a longer one.
fn preintegrated_2d_between(ends: vec2f, length: f32) -> Classified {
    let entry = preintegrated_2d_entry(ends);
    let transmittance = preintegrated_2d_transmittance(entry);
    let part = length / transfer.preintegration_length;
    if abs(part - 1.0) < 1.0e-4 {
        return Classified(entry.xyz, transmittance);
    }
    let part_transmittance = exp(-preintegrated_2d_depth(entry) * part);
    let whole_opacity = 1.0 - transmittance;
    let ratio = select(part, (1.0 - part_transmittance) / whole_opacity, whole_opacity > 1.0e-4);
    return Classified(entry.xyz * ratio, part_transmittance);
}

// Places in the table, in entries.
fn preintegrated_2d_ends(front: f32, back: f32) -> vec2f {
    return (vec2f(front, back) - transfer.low) * transfer.preintegration_per_scalar;
}

// Between two scalars, over a world length. What leaves the table is cut there.
fn preintegrated_2d_piece(front: f32, back: f32, length: f32) -> Classified {
    let ends = preintegrated_2d_ends(front, back);
    let inside = clamp(ends, vec2f(0.0), vec2f(transfer.preintegration_last));
    if !transfer_reach_is_short() || all(inside == ends) {
        return preintegrated_2d_between(inside, length);
    }
    let lengths = transfer_shares(ends, transfer.preintegration_last) * length;
    let before = preintegrated_2d_between(inside.xx, lengths.x);
    let behind = preintegrated_2d_between(inside.yy, lengths.z);
    return classified_behind(classified_behind(before, preintegrated_2d_between(inside, lengths.y)), behind);
}

fn classify_segment(ray: Ray, segment: Segment) -> Classified {
    let front = segment.front.scalar;
    let back = segment.back.scalar;
    // Whole segments within the table are its entries as they are. It is known at build time which do.
    if segment.is_step && !transfer_reach_is_short() {
        let entry = preintegrated_2d_entry(preintegrated_2d_ends(front, back));
        return Classified(entry.xyz, preintegrated_2d_transmittance(entry));
    }
    // Segments that know their middle are two of the table's, of one length: the scalar runs linearly through both.
    // All others know at build time that they do not, so this costs them nothing.
    if segment.has_middle {
        let middle = 0.5 * (front + back);
        let near = preintegrated_2d_piece(front, middle, 0.5 * segment.length);
        return classified_behind(near, preintegrated_2d_piece(middle, back, 0.5 * segment.length));
    }
    return preintegrated_2d_piece(front, back, segment.length);
}
