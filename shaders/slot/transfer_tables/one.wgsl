// Which tables of transfer functions are read: those of one.
#import "lib/transfer_row.wgsl"

@group(2) @binding(0) var<uniform> transfer: Transfer;
@group(2) @binding(1) var transfer_table: texture_2d<f32>;
@group(2) @binding(2) var preintegration_table: texture_2d<f32>;
@group(2) @binding(5) var nearest_sampler: sampler;

// The entry at a texture coordinate. The nearest one: with 8192 entries its rounding is below the error of the
// quadrature. The sampler clamps; a load would be checked against the table's size each time.
fn transfer_entry(place: f32) -> vec4f {
    return textureSampleLevel(transfer_table, nearest_sampler, vec2f(place, 0.5), 0.0);
}

// An entry of the pre-integrated table.
fn transfer_cell(at: vec2i) -> vec4f {
    return textureLoad(preintegration_table, at, 0);
}

// Makes the tables those of a row.
fn transfer_select(row: u32) {
}
