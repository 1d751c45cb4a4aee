// Which tables of transfer functions are read: those of four volumes, of which one was selected last.
#import "lib/nearest_entry.wgsl"
#import "lib/nearest_sampler.wgsl"
#import "lib/tables.wgsl"
#import "lib/volume_transfers.wgsl"
#import slot "table_filter"

@group(2) @binding(50) var transfer_2_table: texture_2d<f32>;
@group(2) @binding(51) var preintegration_2_table: texture_2d<f32>;
@group(2) @binding(52) var preintegration_half_2_table: texture_2d<f32>;
@group(2) @binding(53) var integral_2_table: texture_2d<f32>;
@group(2) @binding(60) var transfer_3_table: texture_2d<f32>;
@group(2) @binding(61) var preintegration_3_table: texture_2d<f32>;
@group(2) @binding(62) var preintegration_half_3_table: texture_2d<f32>;
@group(2) @binding(63) var integral_3_table: texture_2d<f32>;
@group(2) @binding(70) var transfer_4_table: texture_2d<f32>;
@group(2) @binding(71) var preintegration_4_table: texture_2d<f32>;
@group(2) @binding(72) var preintegration_half_4_table: texture_2d<f32>;
@group(2) @binding(73) var integral_4_table: texture_2d<f32>;

// The entry at a texture coordinate.
fn transfer_entry(place: f32) -> vec4f {
    if transfer_chosen == 1u {
        return textureSampleLevel(transfer_2_table, nearest_sampler, vec2f(place, 0.5), 0.0);
    }
    if transfer_chosen == 2u {
        return textureSampleLevel(transfer_3_table, nearest_sampler, vec2f(place, 0.5), 0.0);
    }
    if transfer_chosen == 3u {
        return textureSampleLevel(transfer_4_table, nearest_sampler, vec2f(place, 0.5), 0.0);
    }
    return textureSampleLevel(transfer_table, nearest_sampler, vec2f(place, 0.5), 0.0);
}

// The pre-integrated table at a place between its entries: premultiplied colour and optical depth.
fn transfer_entries(place: vec2f) -> vec4f {
    if transfer_chosen == 1u {
        return between_all_entries(preintegration_2_table, place, transfer.preintegration_last);
    }
    if transfer_chosen == 2u {
        return between_all_entries(preintegration_3_table, place, transfer.preintegration_last);
    }
    if transfer_chosen == 3u {
        return between_all_entries(preintegration_4_table, place, transfer.preintegration_last);
    }
    return between_all_entries(preintegration_table, place, transfer.preintegration_last);
}

// The nearest entry of the pre-integrated table: premultiplied colour and transmittance.
fn transfer_nearest_entry(place: vec2f) -> vec4f {
    if transfer_chosen == 1u {
        return nearest_entry(preintegration_2_table, place, transfer.preintegration_last);
    }
    if transfer_chosen == 2u {
        return nearest_entry(preintegration_3_table, place, transfer.preintegration_last);
    }
    if transfer_chosen == 3u {
        return nearest_entry(preintegration_4_table, place, transfer.preintegration_last);
    }
    return nearest_entry(preintegration_table, place, transfer.preintegration_last);
}

// The pre-integrated table of half segments at a place between its entries.
fn transfer_half_entries(place: vec2f) -> vec4f {
    if transfer_chosen == 1u {
        return between_all_entries(preintegration_half_2_table, place, transfer.half_last);
    }
    if transfer_chosen == 2u {
        return between_all_entries(preintegration_half_3_table, place, transfer.half_last);
    }
    if transfer_chosen == 3u {
        return between_all_entries(preintegration_half_4_table, place, transfer.half_last);
    }
    return between_all_entries(preintegration_half_table, place, transfer.half_last);
}

// The table of integrals (see `transfer_mean`).
fn transfer_integral(column: i32, row: i32) -> vec4f {
    if transfer_chosen == 1u {
        return textureLoad(integral_2_table, vec2i(column, row), 0);
    }
    if transfer_chosen == 2u {
        return textureLoad(integral_3_table, vec2i(column, row), 0);
    }
    if transfer_chosen == 3u {
        return textureLoad(integral_4_table, vec2i(column, row), 0);
    }
    return textureLoad(integral_table, vec2i(column, row), 0);
}
