// Several volumes, each with a transfer function: that which was selected last is read.
#import "lib/placement.wgsl"
#import "lib/transfer_row.wgsl"

struct VolumesRow {
    @align(16) placement: Volume,
    @align(16) transfer: Transfer,
    // Whether its scalars hold for whole voxels, as those of labels do.
    @align(16) is_nearest: u32,
}

struct Volumes {
    rows: array<VolumesRow, 4>,
}

@group(1) @binding(20) var<uniform> volumes: Volumes;

var<private> volume: Volume;
var<private> transfer: Transfer;
var<private> volumes_chosen: u32;

// Makes `volume` and `transfer` those of a number, from 0.
fn volumes_select(index: u32) {
    volumes_chosen = index;
    volume = volumes.rows[index].placement;
    transfer = volumes.rows[index].transfer;
}

// Where a texture is filtered: at the point, or in the middle of its voxel where scalars hold for whole voxels.
fn volumes_place(position: vec3f) -> vec3f {
    if volumes.rows[volumes_chosen].is_nearest == 0u {
        return position;
    }
    let last = volume.dims - 1.0;
    return (clamp(floor(position * volume.dims), vec3f(0.0), last) + 0.5) / volume.dims;
}
