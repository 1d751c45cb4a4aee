// Where do lights shine from? All from the eye, which is known when the shader is built: that spares a few roots and
// divisions of each segment.
#import "lib/lights.wgsl"

// The light of a number below `params.lights`, as a world position sees it; `to_eye` is the unit direction back.
fn lights_at(index: u32, world: vec3f, to_eye: vec3f) -> Light {
    return Light(to_eye, LIGHT_FAR, lights_color(index));
}

// The unit direction half way between a light and the eye, where highlights are.
fn lights_half_way(light: Light, to_eye: vec3f, normal: vec3f) -> vec3f {
    return to_eye;
}
