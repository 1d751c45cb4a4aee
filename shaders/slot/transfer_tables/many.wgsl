// Which tables of transfer functions are read: those of the row that was selected last.
#import "lib/nearest_sampler.wgsl"
#import "lib/transfer_row.wgsl"
#import slot "table_filter"

struct TransferRow {
    @align(16) transfer: Transfer,
    // The first entry of its pre-integrated table, and the texture coordinate of its row in the other one.
    @align(16) tile: vec2u,
    place: f32,
    // The first row of its table of integrals.
    integral_row: u32,
    // The first entry of its pre-integrated table of half segments.
    half_tile: vec2u,
}

struct TransferRows {
    rows: array<TransferRow, 256>,
}

@group(2) @binding(30) var<uniform> transfers: TransferRows;
@group(2) @binding(31) var transfer_tables: texture_2d<f32>;
@group(2) @binding(32) var preintegration_tables: texture_2d<f32>;
@group(2) @binding(33) var integral_tables: texture_2d<f32>;
@group(2) @binding(34) var preintegration_half_tables: texture_2d<f32>;

var<private> transfer: Transfer;
var<private> transfer_tile: vec2i;
var<private> transfer_place: f32;
var<private> transfer_integral_row: i32;
var<private> transfer_half_tile: vec2i;

// The entry at a texture coordinate. The nearest one: with 8192 entries its rounding is below the error of the
// quadrature. The sampler clamps; a load would be checked against the table's size each time.
fn transfer_entry(place: f32) -> vec4f {
    return textureSampleLevel(transfer_tables, nearest_sampler, vec2f(place, transfer_place), 0.0);
}

// The pre-integrated table at a place between its entries: premultiplied colour and optical depth.
fn transfer_entries(place: vec2f) -> vec4f {
    return between_entries(preintegration_tables, place, transfer.preintegration_last, transfer_tile);
}

// The nearest entry of the pre-integrated table: premultiplied colour and transmittance.
fn transfer_nearest_entry(place: vec2f) -> vec4f {
    let inside = clamp(place, vec2f(0.0), vec2f(transfer.preintegration_last));
    return textureLoad(preintegration_tables, vec2i(inside + 0.5) + transfer_tile, 0);
}

// The pre-integrated table of half segments at a place between its entries.
fn transfer_half_entries(place: vec2f) -> vec4f {
    return between_entries(preintegration_half_tables, place, transfer.half_last, transfer_half_tile);
}

// The table of integrals (see `transfer_mean`).
fn transfer_integral(column: i32, row: i32) -> vec4f {
    return textureLoad(integral_tables, vec2i(column, transfer_integral_row + row), 0);
}

// Makes the tables those of a row.
fn transfer_select(row: u32) {
    transfer = transfers.rows[row].transfer;
    transfer_tile = vec2i(transfers.rows[row].tile);
    transfer_place = transfers.rows[row].place;
    transfer_integral_row = i32(transfers.rows[row].integral_row);
    transfer_half_tile = vec2i(transfers.rows[row].half_tile);
}
