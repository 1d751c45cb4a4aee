// Which volume is read: the only one, in bricks of several levels, from eight loads for formats that the device cannot filter.
#import "lib/only_volume.wgsl"
#import "lib/pages.wgsl"

// How many voxels wide the samples are that are read at a position.
fn volumes_grain(position: vec3f) -> f32 {
    return f32(1u << pages_at(bricks_at(bricks_place(position))).level);
}

// The texel at a position, trilinear.
fn volumes_filter(position: vec3f) -> f32 {
    let last = vec3i(pages.texels) - 1;
    let place = pages_place(position, volume.dims) - 0.5;
    let low = clamp(vec3i(floor(place)), vec3i(0), last);
    let high = min(low + 1, last);
    let part = place - floor(place);
    let x00 = mix(volumes_texel(low), volumes_texel(vec3i(high.x, low.y, low.z)), part.x);
    let x10 = mix(volumes_texel(vec3i(low.x, high.y, low.z)), volumes_texel(vec3i(high.x, high.y, low.z)), part.x);
    let x01 = mix(volumes_texel(vec3i(low.x, low.y, high.z)), volumes_texel(vec3i(high.x, low.y, high.z)), part.x);
    let x11 = mix(volumes_texel(vec3i(low.x, high.y, high.z)), volumes_texel(high), part.x);
    return mix(mix(x00, x10, part.y), mix(x01, x11, part.y), part.z);
}

fn volumes_texel(index: vec3i) -> f32 {
    return textureLoad(brick_pool, index, 0).x;
}

// The texel of a voxel; where the bricks are coarser, what is at its centre.
fn volumes_load(index: vec3i) -> f32 {
    let inside = clamp(vec3f(index), vec3f(0.0), volume.dims - 1.0);
    return volumes_filter((inside + 0.5) / volume.dims);
}
