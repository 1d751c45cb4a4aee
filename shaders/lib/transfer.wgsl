// The transfer function's tables: where they start and end, and lookups.

struct Transfer {
    // Scalar of the first entry, and entries per scalar: index = (scalar - low) * entries_per_scalar.
    low: f32,
    entries_per_scalar: f32,
    // Highest index, as a float for the clamp.
    last_entry: f32,
    // The same for the pre-integrated table.
    preintegration_per_scalar: f32,
    preintegration_last: f32,
    // Reference lengths per world unit: tables hold extinction per reference length.
    references_per_world: f32,
    // World length of the segments that the pre-integrated table is made for.
    preintegration_length: f32,
}

@group(2) @binding(0) var<uniform> transfer: Transfer;
@group(2) @binding(1) var transfer_table: texture_2d<f32>;
@group(2) @binding(2) var preintegration_table: texture_2d<f32>;

// Linear colour and extinction per reference length at a scalar. The nearest entry: with 8192 entries its
// rounding is below the error of the quadrature, and a load is a third faster than a filtered read.
fn transfer_at(scalar: f32) -> vec4f {
    let index = clamp((scalar - transfer.low) * transfer.entries_per_scalar, 0.0, transfer.last_entry);
    return textureLoad(transfer_table, vec2i(i32(index + 0.5), 0), 0);
}

// Premultiplied colour and optical depth of a segment between two scalars, bilinear between table entries.
fn transfer_between(front: f32, back: f32) -> vec4f {
    let scalars = (vec2f(front, back) - transfer.low) * transfer.preintegration_per_scalar;
    let place = clamp(scalars, vec2f(0.0), vec2f(transfer.preintegration_last));
    let low = min(floor(place), vec2f(transfer.preintegration_last - 1.0));
    let part = place - low;
    let at = vec2i(low);
    let near = mix(
        textureLoad(preintegration_table, at, 0),
        textureLoad(preintegration_table, at + vec2i(1, 0), 0),
        part.x,
    );
    let far = mix(
        textureLoad(preintegration_table, at + vec2i(0, 1), 0),
        textureLoad(preintegration_table, at + vec2i(1, 1), 0),
        part.x,
    );
    return mix(near, far, part.y);
}
