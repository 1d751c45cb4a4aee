// Which volume is read: that of four which was selected last.
#import "lib/nearest_sampler.wgsl"
#import "lib/tables.wgsl"
#import "lib/volume_texture.wgsl"
#import "lib/volumes.wgsl"
#import slot "table_filter"

@group(1) @binding(21) var volume_2_texture: texture_3d<f32>;
@group(1) @binding(22) var volume_3_texture: texture_3d<f32>;
@group(1) @binding(23) var volume_4_texture: texture_3d<f32>;
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

const VOLUMES_COUNT: u32 = 4u;

// The texel at a position, by the device's filter.
fn volumes_filter(position: vec3f) -> f32 {
    if volumes_chosen == 1u {
        return textureSampleLevel(volume_2_texture, linear_sampler, position, 0.0).x;
    }
    if volumes_chosen == 2u {
        return textureSampleLevel(volume_3_texture, linear_sampler, position, 0.0).x;
    }
    if volumes_chosen == 3u {
        return textureSampleLevel(volume_4_texture, linear_sampler, position, 0.0).x;
    }
    return textureSampleLevel(volume_texture, linear_sampler, position, 0.0).x;
}

// The texel of a voxel.
fn volumes_load(index: vec3i) -> f32 {
    if volumes_chosen == 1u {
        return textureLoad(volume_2_texture, index, 0).x;
    }
    if volumes_chosen == 2u {
        return textureLoad(volume_3_texture, index, 0).x;
    }
    if volumes_chosen == 3u {
        return textureLoad(volume_4_texture, index, 0).x;
    }
    return textureLoad(volume_texture, index, 0).x;
}

// See `transfer_tables`.
fn volumes_entry(place: vec2f) -> vec4f {
    if volumes_chosen == 1u {
        return textureSampleLevel(transfer_2_table, nearest_sampler, place, 0.0);
    }
    if volumes_chosen == 2u {
        return textureSampleLevel(transfer_3_table, nearest_sampler, place, 0.0);
    }
    if volumes_chosen == 3u {
        return textureSampleLevel(transfer_4_table, nearest_sampler, place, 0.0);
    }
    return textureSampleLevel(transfer_table, nearest_sampler, place, 0.0);
}

fn volumes_entries(place: vec2f, last: f32) -> vec4f {
    if volumes_chosen == 1u {
        return between_entries(preintegration_2_table, place, last, vec2i(0));
    }
    if volumes_chosen == 2u {
        return between_entries(preintegration_3_table, place, last, vec2i(0));
    }
    if volumes_chosen == 3u {
        return between_entries(preintegration_4_table, place, last, vec2i(0));
    }
    return between_entries(preintegration_table, place, last, vec2i(0));
}

fn volumes_half_entries(place: vec2f, last: f32) -> vec4f {
    if volumes_chosen == 1u {
        return between_entries(preintegration_half_2_table, place, last, vec2i(0));
    }
    if volumes_chosen == 2u {
        return between_entries(preintegration_half_3_table, place, last, vec2i(0));
    }
    if volumes_chosen == 3u {
        return between_entries(preintegration_half_4_table, place, last, vec2i(0));
    }
    return between_entries(preintegration_half_table, place, last, vec2i(0));
}

fn volumes_integral(at: vec2i) -> vec4f {
    if volumes_chosen == 1u {
        return textureLoad(integral_2_table, at, 0);
    }
    if volumes_chosen == 2u {
        return textureLoad(integral_3_table, at, 0);
    }
    if volumes_chosen == 3u {
        return textureLoad(integral_4_table, at, 0);
    }
    return textureLoad(integral_table, at, 0);
}
