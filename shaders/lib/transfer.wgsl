// Lookups in the transfer function's tables; of a segmented volume, in those of the label that is walked through.
#import slot "transfer_reach"
#import slot "transfer_tables"

// Texture coordinate of a scalar's entry. Samplers clamp it, but software ones count texels in 32 bits before they do: of
// 2^31 texels beyond the last one they make the first.
fn transfer_coordinate(scalar: f32) -> f32 {
    let place = scalar * transfer.entry_scale + transfer.entry_bias;
    if transfer_reach_is_short() {
        return clamp(place, 0.0, 1.0);
    }
    return place;
}

// Linear colour and extinction per reference length at a scalar.
fn transfer_at(scalar: f32) -> vec4f {
    return transfer_entry(transfer_coordinate(scalar));
}

// As `transfer_at`, linear between two entries: the nearest one is a floor under errors of quadratures of order 4.
fn transfer_linear(scalar: f32) -> vec4f {
    let place = transfer_coordinate(scalar) * transfer.entries - 0.5;
    let low = floor(place);
    let near = transfer_entry((low + 0.5) / transfer.entries);
    return mix(near, transfer_entry((low + 1.5) / transfer.entries), place - low);
}

// Means over the scalars from front to back: of linear colour times extinction, and of extinction per reference length.
// The mean is a difference of two integrals by the difference of two scalars, both counted in entries and as they were
// rounded: a mean over scalars 0.0005 entries away is as good. The integrals are sums of two floats each, since one of
// their own would be off by up to 0.0005 entries of extinction and ruin the means of close scalars. So nothing cancels.
// Inside of one entry the table knows no more than its mean; there the mean is the transfer function at the centre.
fn transfer_mean(front: f32, back: f32) -> vec4f {
    let places = (vec2f(front, back) - transfer.low) * transfer.integral_per_scalar;
    let change = places.y - places.x;
    if abs(change) < 1.0 {
        let entry = transfer_linear(0.5 * (front + back));
        return vec4f(entry.xyz * entry.w, entry.w);
    }
    // Column 0 is what is below the first entry, the last one what is above the last.
    let cells = clamp(floor(places), vec2f(-1.0), vec2f(transfer.integral_last));
    let columns = vec2i(cells) + 1;
    let parts = places - cells;
    let whole = transfer_integral(columns.y, 0) - transfer_integral(columns.x, 0);
    let rest = transfer_integral(columns.y, 1) - transfer_integral(columns.x, 1);
    let inside = parts.y * transfer_integral(columns.y, 2) - parts.x * transfer_integral(columns.x, 2);
    return max((whole + (rest + inside)) / change, vec4f(0.0));
}

// The optical depth that the nearest entry of the pre-integrated table stands for by its transmittance. Beyond a depth of 64, of
// which no light is left, entries are as small as that still tells how deep they are: a part of a segment may let light
// through that the whole one does not.
fn transfer_depth(transmittance: f32) -> f32 {
    let depth = -log(max(transmittance, 1.0e-37));
    return select(depth, 64.0 * exp(depth - 64.0), depth > 64.0);
}

// Shares of a segment, of which the ends are so many entries from a table's first: before it enters the table, which
// ends at `last`, within it, and behind it. Beyond the table its first and last entry hold.
fn transfer_shares(ends: vec2f, last: f32) -> vec3f {
    let inside = clamp(ends, vec2f(0.0), vec2f(last));
    let way = abs(ends.y - ends.x);
    if inside.x == inside.y || way <= 0.0 {
        return vec3f(0.0, 1.0, 0.0);
    }
    let shares = vec2f(abs(inside.x - ends.x), abs(ends.y - inside.y)) / way;
    return vec3f(shares.x, max(1.0 - shares.x - shares.y, 0.0), shares.y);
}
