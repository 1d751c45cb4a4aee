// Which tables of transfer functions are read: those of the row that was selected last.
#import "lib/between.wgsl"
#import "lib/transfer_row.wgsl"

struct TransferRow {
    @align(16) transfer: Transfer,
    // The first entry of its pre-integrated table, and the texture coordinate of its row in the other one.
    @align(16) tile: vec2u,
    place: f32,
}

struct TransferRows {
    rows: array<TransferRow, 256>,
}

@group(2) @binding(30) var<uniform> transfers: TransferRows;
@group(2) @binding(31) var transfer_tables: texture_2d<f32>;
@group(2) @binding(32) var preintegration_tables: texture_2d<f32>;
@group(2) @binding(5) var nearest_sampler: sampler;

var<private> transfer: Transfer;
var<private> transfer_tile: vec2i;
var<private> transfer_place: f32;

// The entry at a texture coordinate. The nearest one: with 8192 entries its rounding is below the error of the
// quadrature. The sampler clamps; a load would be checked against the table's size each time.
fn transfer_entry(place: f32) -> vec4f {
    return textureSampleLevel(transfer_tables, nearest_sampler, vec2f(place, transfer_place), 0.0);
}

// The pre-integrated table at a place between its entries.
fn transfer_entries(place: vec2f) -> vec4f {
    return between_entries(preintegration_tables, place, transfer.preintegration_last, transfer_tile);
}

// Makes the tables those of a row.
fn transfer_select(row: u32) {
    transfer = transfers.rows[row].transfer;
    transfer_tile = vec2i(transfers.rows[row].tile);
    transfer_place = transfers.rows[row].place;
}
