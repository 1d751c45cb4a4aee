// Where do lights shine from? From anywhere: each is directional, at a point or at the eye.
#import "lib/lights.wgsl"

// The light of a number below `params.lights`, as a world position sees it; `to_eye` is the unit direction back.
fn lights_at(index: u32, world: vec3f, to_eye: vec3f) -> Light {
    let given = lights_given(index);
    let color = lights_color(index);
    if given.w == 0.0 {
        let square = dot(given.xyz, given.xyz);
        let direction = select(to_eye, given.xyz * inverseSqrt(max(square, 1.0e-30)), square > 0.0);
        return Light(direction, LIGHT_FAR, color);
    }
    let towards = space_point(given.xyz / given.w) - world;
    let distance = max(length(towards), 1.0e-20);
    return Light(towards / distance, distance, color);
}

// The unit direction half way between a light and the eye, where highlights are. The normal keeps opposite ones apart.
fn lights_half_way(light: Light, to_eye: vec3f, normal: vec3f) -> vec3f {
    let sum = light.direction + to_eye + 1.0e-6 * normal;
    return sum * inverseSqrt(max(dot(sum, sum), 1.0e-30));
}
