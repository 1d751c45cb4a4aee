// Several volumes: that which was selected last is read.
#import "lib/placement.wgsl"

struct VolumesRow {
    @align(16) placement: Volume,
    // Whether its scalars hold for whole voxels, as those of labels do.
    @align(16) is_nearest: u32,
}

struct Volumes {
    rows: array<VolumesRow, 4>,
}

@group(1) @binding(40) var<uniform> volumes: Volumes;

var<private> volume: Volume;
var<private> volumes_chosen: u32;

// Makes `volume` that of a number, from 0.
fn volumes_select(index: u32) {
    volumes_chosen = index;
    volume = volumes.rows[index].placement;
}

// Whether the scalars of the volume of a number hold for whole voxels.
fn volumes_is_nearest(index: u32) -> bool {
    return volumes.rows[index].is_nearest != 0u;
}

// How many voxels wide the samples are that are read at a position.
fn volumes_grain(position: vec3f) -> f32 {
    return 1.0;
}

// Where a texture is filtered: at the point, or in the middle of its voxel where scalars hold for whole voxels.
fn volumes_place(position: vec3f) -> vec3f {
    if !volumes_is_nearest(volumes_chosen) {
        return position;
    }
    let last = volume.dims - 1.0;
    return (clamp(floor(position * volume.dims), vec3f(0.0), last) + 0.5) / volume.dims;
}
