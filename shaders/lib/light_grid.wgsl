// The grid of light: points over the volume's box, the outer ones on its faces, in an atlas of slices.

struct Params {
    /// Points of the grid of light along the longest side of the volume's box; in proportion along the others.
    /// @default 64 @range 8 256
    light_resolution: u32,
}

struct LightGrid {
    // Points along each axis, and slices in a row of the atlas.
    dims: vec3u,
    columns: u32,
    // World position of a point from its number along each axis.
    world_from_point: mat4x4f,
}

@group(3) @binding(21) var<uniform> light_grid: LightGrid;

// The first texel of a slice.
fn light_grid_corner(slice: u32) -> vec2u {
    return vec2u(slice % light_grid.columns, slice / light_grid.columns) * light_grid.dims.xy;
}
