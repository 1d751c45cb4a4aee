// A point of a surface.
#import "lib/ray.wgsl"

// A unit normal, as a direction of any length and what makes it a unit long, so that who asks only for its angle to
// another direction multiplies once; 0 where there is no normal.
struct Facing {
    direction: vec3f,
    per_length: f32,
}

struct SurfacePoint {
    // World position, and texture coordinates.
    world: vec3f,
    position: vec3f,
    // Unit world normal, towards the eye.
    normal: vec3f,
    scalar: f32,
}
