// Bricks of the volume: cubes of voxels, of which something is known that holds for all scalars inside.

struct Bricks {
    // How many there are along each axis; the last ones may be cut off.
    dims: vec3i,
    // Maps of bricks are slices along z side by side: how many in a row.
    columns: i32,
    // Bricks for the whole of the texture coordinates.
    per_texture: vec3f,
    // From the texture's corner to the first brick's: bricks go from voxel centre to voxel centre, so that they are made of as few
    // voxels as can be. What is before the first one belongs to it.
    shift: vec3f,
    // What counts as far away, in bricks: leaps go so many at once, and looks for farther ones would take longer than that gains.
    farthest: u32,
    // Texels of a map.
    map_size: vec2f,
}

@group(1) @binding(30) var<uniform> bricks: Bricks;

// Texture coordinates counted in bricks.
fn bricks_place(position: vec3f) -> vec3f {
    return position * bricks.per_texture - bricks.shift;
}

// The brick at a place that is counted in bricks.
fn bricks_at(place: vec3f) -> vec3i {
    return clamp(vec3i(floor(place)), vec3i(0), bricks.dims - vec3i(1));
}

// Where a brick's texel is in a map. Whole numbers are divided one by one on processors: floats are not.
fn bricks_texel(brick: vec3i) -> vec2i {
    let row = i32((f32(brick.z) + 0.5) / f32(bricks.columns));
    return vec2i(brick.z - row * bricks.columns, row) * bricks.dims.xy + brick.xy;
}

// The middle of that texel in texture coordinates.
fn bricks_in_map(brick: vec3i) -> vec2f {
    return (vec2f(bricks_texel(brick)) + 0.5) / bricks.map_size;
}
