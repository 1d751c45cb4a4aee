// A point of a surface.
#import "lib/ray.wgsl"

struct SurfacePoint {
    // World position, and texture coordinates.
    world: vec3f,
    position: vec3f,
    // Unit world normal, towards the eye.
    normal: vec3f,
    scalar: f32,
}
