// Lookups in the transfer function's tables; of a segmented volume, in those of the label that is walked through.
#import slot "transfer_tables"

// Linear colour and extinction per reference length at a scalar.
fn transfer_at(scalar: f32) -> vec4f {
    return transfer_entry(scalar * transfer.entry_scale + transfer.entry_bias);
}

// Premultiplied colour and optical depth of a segment between two scalars, bilinear between table entries.
fn transfer_between(front: f32, back: f32) -> vec4f {
    let scalars = (vec2f(front, back) - transfer.low) * transfer.preintegration_per_scalar;
    let place = clamp(scalars, vec2f(0.0), vec2f(transfer.preintegration_last));
    let low = min(floor(place), vec2f(transfer.preintegration_last - 1.0));
    let part = place - low;
    let at = vec2i(low);
    let near = mix(
        transfer_cell(at),
        transfer_cell(at + vec2i(1, 0)),
        part.x,
    );
    let far = mix(
        transfer_cell(at + vec2i(0, 1)),
        transfer_cell(at + vec2i(1, 1)),
        part.x,
    );
    return mix(near, far, part.y);
}
