// Which volume is read: the only one, in bricks of several levels.
#import "lib/only_volume.wgsl"
#import "lib/pages.wgsl"
#import "lib/volume_texture.wgsl"

// How many voxels wide the samples are that are read at a position.
fn volumes_grain(position: vec3f) -> f32 {
    return f32(1u << pages_at(bricks_at(bricks_place(position))).level);
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
