// A sample of the volume along a ray.
#import "lib/ray.wgsl"
#import slot "reconstruct"

// At a world distance from the ray's entry.
fn sample_along(ray: Ray, distance: f32) -> Sample {
    let position = ray_position(ray, distance);
    return Sample(position, reconstruct_scalar(position));
}
