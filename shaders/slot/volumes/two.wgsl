// Which volume is read: that of two which was selected last.
#import "lib/nearest_sampler.wgsl"
#import "lib/tables.wgsl"
#import "lib/volume_texture.wgsl"
#import "lib/volumes.wgsl"
#import slot "table_filter"

@group(1) @binding(21) var volume_2_texture: texture_3d<f32>;
@group(2) @binding(50) var transfer_2_table: texture_2d<f32>;
@group(2) @binding(51) var preintegration_2_table: texture_2d<f32>;
@group(2) @binding(52) var preintegration_half_2_table: texture_2d<f32>;
@group(2) @binding(53) var integral_2_table: texture_2d<f32>;

const VOLUMES_COUNT: u32 = 2u;

// The texel at a position, by the device's filter.
fn volumes_filter(position: vec3f) -> f32 {
    if volumes_chosen == 1u {
        return textureSampleLevel(volume_2_texture, linear_sampler, position, 0.0).x;
    }
    return textureSampleLevel(volume_texture, linear_sampler, position, 0.0).x;
}

// The texel of a voxel.
fn volumes_load(index: vec3i) -> f32 {
    if volumes_chosen == 1u {
        return textureLoad(volume_2_texture, index, 0).x;
    }
    return textureLoad(volume_texture, index, 0).x;
}

// See `transfer_tables`.
fn volumes_entry(place: vec2f) -> vec4f {
    if volumes_chosen == 1u {
        return textureSampleLevel(transfer_2_table, nearest_sampler, place, 0.0);
    }
    return textureSampleLevel(transfer_table, nearest_sampler, place, 0.0);
}

fn volumes_entries(place: vec2f, last: f32) -> vec4f {
    if volumes_chosen == 1u {
        return between_entries(preintegration_2_table, place, last, vec2i(0));
    }
    return between_entries(preintegration_table, place, last, vec2i(0));
}

fn volumes_half_entries(place: vec2f, last: f32) -> vec4f {
    if volumes_chosen == 1u {
        return between_entries(preintegration_half_2_table, place, last, vec2i(0));
    }
    return between_entries(preintegration_half_table, place, last, vec2i(0));
}

fn volumes_integral(at: vec2i) -> vec4f {
    if volumes_chosen == 1u {
        return textureLoad(integral_2_table, at, 0);
    }
    return textureLoad(integral_table, at, 0);
}
