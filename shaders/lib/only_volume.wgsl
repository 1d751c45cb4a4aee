// The only volume that there is, whatever texture has its texels.
#import "lib/placement.wgsl"

@group(1) @binding(0) var<uniform> volume: Volume;

const VOLUMES_COUNT: u32 = 1u;

// Makes `volume` that of a number, from 0.
fn volumes_select(index: u32) {
}

// Whether the scalars of the volume of a number hold for whole voxels.
fn volumes_is_nearest(index: u32) -> bool {
    return false;
}

// Where a texture is filtered.
fn volumes_place(position: vec3f) -> vec3f {
    return position;
}
