// Lookups in the transfer function's tables; of a segmented volume, in those of the label that is walked through.
#import slot "transfer_tables"

// Linear colour and extinction per reference length at a scalar.
fn transfer_at(scalar: f32) -> vec4f {
    return transfer_entry(scalar * transfer.entry_scale + transfer.entry_bias);
}

// Premultiplied colour and optical depth of a segment between two scalars, bilinear between table entries.
fn transfer_between(front: f32, back: f32) -> vec4f {
    return transfer_entries((vec2f(front, back) - transfer.low) * transfer.preintegration_per_scalar);
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
