// Where the proxy geometry is drawn: a box, that of the volume or a smaller one.
#import "lib/volume.wgsl"

struct Tile {
    // The first pixel of the rectangle that a compute dispatch covers.
    first: vec2u,
    // World position of the box's middle, half of its smallest side, and the world distance from the middle to a corner.
    centre: vec3f,
    half_side: f32,
    radius: f32,
}

@group(0) @binding(6) var<uniform> tile: Tile;

// The clip position of a corner of the box, drawn a little larger than it is: rasterisers place corners on a grid of parts
// of a pixel, and no ray that meets the box may be lost at its outline. Rays beside the box find that out themselves.
fn proxy_clip_from_world(world: vec3f) -> vec4f {
    let from_anchor = length(tile.centre - camera.anchor);
    let distance = select(camera.skipped + from_anchor + tile.radius, 1.0, lens.is_orthographic != 0u);
    let pixel = 2.0 * lens.half_extent.y / lens.size.y * distance;
    let larger = 1.0 + 2.0 * pixel / tile.half_side;
    return frame_clip_from_world(tile.centre + (world - tile.centre) * larger);
}
