// Where a light at the eye is: where the camera stands.
#import "lib/eye.wgsl"

// Unit direction from a world position to the eye, and the distance.
fn eye_light_towards(world: vec3f) -> vec4f {
    return eye_towards(world);
}
