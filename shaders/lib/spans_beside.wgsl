// How far apart the rays of a tile are.
#import "lib/bricks.wgsl"
#import "lib/ray.wgsl"
#import "lib/spans.wgsl"
#import "lib/volume.wgsl"

// World distance from a ray's origin that no point of the volume is beyond.
fn spans_farthest(ray: Ray) -> f32 {
    return distance(ray.origin, volume.centre) + volume.radius;
}

// Bricks along each axis between the ray through a tile's middle and those at its corners, at most, where they leave the volume.
fn spans_beside(middle: Ray) -> vec3f {
    // At distance 1 where rays part.
    let apart = length(spans_pixels()) / lens.size.y * lens.half_extent.y;
    let world = apart * select(middle.skipped + spans_farthest(middle), 1.0, lens.is_orthographic != 0u);
    let rows = transpose(volume.texture_from_world);
    let per_world = vec3f(length(rows[0].xyz), length(rows[1].xyz), length(rows[2].xyz)) * bricks.per_texture;
    return 1.001 * world * per_world;
}
