// Rays towards lights: they walk over the same parts as the eye's, and so obey clips and labels.
#import "lib/lights.wgsl"
#import slot "parts"
#import "lib/shadow_step.wgsl"
#import slot "reconstruct"

// Whatever the step is, a walk ends (see RAYCAST_MAX_SEGMENTS).
const SHADOW_MAX_SEGMENTS: u32 = 65535u;

// The ray from a world position into a direction, through the volume's box and so far at most.
fn shadow_ray(world: vec3f, direction: vec3f, reach: f32) -> Ray {
    var ray: Ray;
    ray.origin = world;
    ray.direction = direction;
    ray = volume_clip_ray(ray);
    ray.far = min(ray.far, reach);
    return ray;
}

fn shadow_sample(ray: Ray, distance: f32) -> Sample {
    let position = ray_position(ray, distance);
    return Sample(position, reconstruct_scalar(position));
}

// World length of a step.
fn shadow_step_world() -> f32 {
    return params.shadow_step * volume.voxel;
}

// World distance from a part's entry to the end of segment number `index`: whole steps, the last one shorter.
fn shadow_segment_end(ray: Ray, index: u32) -> f32 {
    return min(f32(index + 1u) * shadow_step_world(), ray.far - ray.near);
}
