// Which part of the ray is visible: that in a sphere, or outside of it.
#import "lib/clip.wgsl"
#import "lib/space.wgsl"

struct Params {
    /// The middle of the sphere (see `space`). @default 0 0 0
    clip_centre: vec3f,
    /// Its radius, in the units of `space`. @default 0.8 @range 0 1000000
    clip_radius: f32,
}

// World distances from the ray's entry: where the first visible part starts and ends; the same twice for none.
fn clip_next(ray: Ray) -> vec2f {
    let from_centre = ray_world(ray, 0.0) - space_point(params.clip_centre);
    let middle = -dot(from_centre, ray.direction);
    let nearest = from_centre + middle * ray.direction;
    let radius = space_length(params.clip_radius);
    let half_square = radius * radius - dot(nearest, nearest);
    // A ray that misses leaves before it enters: that is nowhere. (A return from here would do, but makes the Vulkan
    // software driver of Mesa 22.3 crash in a fragment shader.)
    let half = select(-1.0, sqrt(max(half_square, 0.0)), half_square > 0.0);
    return clip_part(ray, vec2f(middle - half, middle + half));
}

// World normal, towards the eye, of the cut at a distance from the ray's entry where a visible part starts.
fn clip_normal(ray: Ray, distance: f32) -> vec3f {
    return clip_facing(ray_world(ray, distance) - space_point(params.clip_centre), ray);
}
