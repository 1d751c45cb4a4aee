// Leaps through boxes of bricks, to the last whole step inside of them: so what is walked is walked by the same segments.
// A step is a world length.
#import "lib/bricks.wgsl"
#import "lib/leap.wgsl"
#import "lib/ray.wgsl"

// Whatever bricks say, a look comes to its end.
const BRICK_LEAP_TURNS: u32 = 8192u;

// Of half a voxel.
const BRICK_LEAP_SLACK: f32 = 0.01;

// The place of a segment's start, counted in bricks.
fn brick_leap_place(ray: Ray, index: u32, step: f32) -> vec3f {
    return bricks_place(ray_position(ray, f32(index) * step));
}

// The number of the first segment from `index` on that does not lie within a box of bricks, in which it is thought to start.
fn brick_leap_through(ray: Ray, index: u32, step: f32, place: vec3f, low: vec3i, high: vec3i) -> u32 {
    let given = ray.slope * bricks.per_texture;
    let slope = select(given, vec3f(1.0e-20), abs(given) < vec3f(1.0e-20));
    // The outer bricks go on outside of the volume. Of others a little is left at the faces: what lies beyond is made of other
    // voxels, and places are rounded.
    let slack = BRICK_LEAP_SLACK * bricks.shift;
    let first = select(vec3f(low) + slack, vec3f(-1.0), low <= vec3i(0));
    let last = select(vec3f(high) - slack, vec3f(bricks.dims + 1), high >= bricks.dims);
    let is_inside = all(place >= first) && all(place <= last);
    let exits = max((first - place) / slope, (last - place) / slope);
    let exit = max(min(min(exits.x, exits.y), exits.z), 0.0);
    // A box may reach far beyond the ray's end.
    let end = min(f32(index) * step + exit, ray.far - ray.near);
    return select(index, max(u32(end / step), index), is_inside);
}

// To go on at a segment from `index` on, and to walk to `end` and the segment there, but no less than so many: an even
// number, since a look costs as much as some segments.
fn brick_leap_to(index: u32, at: u32, end: u32, least: u32) -> Leap {
    let first = max(index, at & ~1u);
    return Leap(first, max((end - first) | 1u, least - 1u) + 1u, 1u);
}
