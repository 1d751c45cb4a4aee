// How much of a light reaches a point: all of it.
#import "lib/lights.wgsl"

// The share of a light, by its number, that reaches a world position. `normal` is the unit world normal of the surface
// that the position is on, zeros inside of a volume.
fn shadow_transmittance(world: vec3f, normal: vec3f, light: Light, index: u32) -> vec3f {
    return vec3f(1.0);
}
