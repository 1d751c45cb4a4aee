// How much of a light reaches a point: what the volume lets through on the way, by classification, along a ray from
// each point that is lit. Of the volume alone: isosurfaces cast no shadow here.
#import "lib/shadow_reach.wgsl"
#import "lib/shadow_through.wgsl"

// The share of a light, by its number, that reaches a world position. `normal` is the unit world normal of the surface
// that the position is on, zeros inside of a volume.
fn shadow_transmittance(world: vec3f, normal: vec3f, light: Light, index: u32) -> vec3f {
    let ray = shadow_ray(world, light.direction, shadow_reach(world, light, index));
    return vec3f(shadow_through(ray));
}
