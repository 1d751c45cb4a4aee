// The transfer function's tables: where they start and end, and lookups.

struct Transfer {
    // Texture coordinate of a scalar's entry: scalar * entry_scale + entry_bias.
    entry_scale: f32,
    entry_bias: f32,
    // Entry of the pre-integrated table: (scalar - low) * preintegration_per_scalar, up to the last one.
    low: f32,
    preintegration_per_scalar: f32,
    preintegration_last: f32,
    // Entry of the table of refractive indices: (scalar - low) * refraction_per_scalar, up to the last one.
    refraction_per_scalar: f32,
    refraction_last: f32,
    // The scalars between which the index changes.
    refraction_from: f32,
    refraction_to: f32,
    // Tables hold extinction per reference length; this makes it powers of two per world unit, for exp2.
    halvings_per_world: f32,
    // World length of the segments that the pre-integrated table is made for.
    preintegration_length: f32,
}

@group(2) @binding(0) var<uniform> transfer: Transfer;
@group(2) @binding(1) var transfer_table: texture_2d<f32>;
@group(2) @binding(2) var preintegration_table: texture_2d<f32>;
@group(2) @binding(5) var nearest_sampler: sampler;

// Linear colour and extinction per reference length at a scalar. The nearest entry: with 8192 entries its rounding is
// below the error of the quadrature. The sampler clamps; a load would be checked against the table's size each time.
fn transfer_at(scalar: f32) -> vec4f {
    let place = vec2f(scalar * transfer.entry_scale + transfer.entry_bias, 0.5);
    return textureSampleLevel(transfer_table, nearest_sampler, place, 0.0);
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
