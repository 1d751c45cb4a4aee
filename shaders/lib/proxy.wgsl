// Where the proxy box is drawn.
#import "lib/volume.wgsl"

// The clip position of a corner of the box, drawn a little larger than it is: rasterisers place corners on a grid of parts
// of a pixel, and no ray that meets the box may be lost at its outline. Rays beside the box find that out themselves.
fn proxy_clip_from_world(world: vec3f) -> vec4f {
    let from_anchor = length(volume.centre - camera.anchor);
    let distance = select(camera.skipped + from_anchor + volume.radius, 1.0, lens.is_orthographic != 0u);
    let pixel = 2.0 * lens.half_extent.y / lens.size.y * distance;
    let larger = 1.0 + 2.0 * pixel / volume.half_side;
    return frame_clip_from_world(volume.centre + (world - volume.centre) * larger);
}
