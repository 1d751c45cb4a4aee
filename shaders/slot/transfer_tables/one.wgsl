// Which tables of transfer functions are read: those of one.
#import "lib/nearest_entry.wgsl"
#import "lib/nearest_sampler.wgsl"
#import "lib/tables.wgsl"
#import "lib/transfer_row.wgsl"
#import slot "table_filter"

@group(2) @binding(0) var<uniform> transfer: Transfer;

// The entry at a texture coordinate. The nearest one: with 8192 entries its rounding is below the error of the
// quadrature. The sampler clamps; a load would be checked against the table's size each time.
fn transfer_entry(place: f32) -> vec4f {
    return textureSampleLevel(transfer_table, nearest_sampler, vec2f(place, 0.5), 0.0);
}

// The pre-integrated table at a place between its entries: premultiplied colour and optical depth.
fn transfer_entries(place: vec2f) -> vec4f {
    return between_all_entries(preintegration_table, place, transfer.preintegration_last);
}

// The nearest entry of the pre-integrated table: premultiplied colour and transmittance.
fn transfer_nearest_entry(place: vec2f) -> vec4f {
    return nearest_entry(preintegration_table, place, transfer.preintegration_last);
}

// The pre-integrated table of half segments at a place between its entries.
fn transfer_half_entries(place: vec2f) -> vec4f {
    return between_all_entries(preintegration_half_table, place, transfer.half_last);
}

// The table of integrals (see `transfer_mean`).
fn transfer_integral(column: i32, row: i32) -> vec4f {
    let place = (vec2f(vec2i(column, row)) + 0.5) / vec2f(textureDimensions(integral_table));
    return textureSampleLevel(integral_table, nearest_sampler, place, 0.0);
}

// Makes the tables those of a row.
fn transfer_select(row: u32) {
}
