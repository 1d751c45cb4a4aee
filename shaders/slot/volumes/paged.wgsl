// Which volume is read: the only one, in bricks of several levels.
#import "lib/pages.wgsl"
#import "lib/placement.wgsl"
#import "lib/volume_texture.wgsl"

@group(1) @binding(0) var<uniform> volume: Volume;

const VOLUMES_COUNT: u32 = 1u;

// Makes `volume` that of a number, from 0.
fn volumes_select(index: u32) {
}

// Whether the scalars of the volume of a number hold for whole voxels.
fn volumes_is_nearest(index: u32) -> bool {
    return false;
}

// How many voxels wide the samples are that are read at a position.
fn volumes_grain(position: vec3f) -> f32 {
    return f32(1u << pages_at(bricks_at(position * bricks.per_texture)).level);
}

// Where a texture is filtered.
fn volumes_place(position: vec3f) -> vec3f {
    return position;
}

// The texel at a position, by the device's filter.
fn volumes_filter(position: vec3f) -> f32 {
    let place = pages_place(position, volume.dims) * pages.per_texel;
    return textureSampleLevel(brick_pool, linear_sampler, place, 0.0).x;
}

// The texel of a voxel; where the bricks are coarser, what is at its centre.
fn volumes_load(index: vec3i) -> f32 {
    let inside = clamp(vec3f(index), vec3f(0.0), volume.dims - 1.0);
    return volumes_filter((inside + 0.5) / volume.dims);
}
