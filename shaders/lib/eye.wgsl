// Where the eye is, for lights there.
#import "lib/frame.wgsl"

// Unit direction from a world position to the eye, or to the eye's plane where rays are parallel, and the distance.
fn eye_towards(world: vec3f) -> vec4f {
    let back = camera.eye - world;
    if lens.is_orthographic != 0u {
        return vec4f(-camera.forward, max(-dot(back, camera.forward), 0.0));
    }
    let distance = max(length(back), 1.0e-20);
    return vec4f(back / distance, distance);
}
