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
