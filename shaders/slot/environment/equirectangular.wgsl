// What a surface mirrors: an image of all directions at the input port `environment`, longitude along its width and
// latitude along its height. Its top is world z up; its middle shows world +y, and world +x lies to the right of that,
// at three quarters of the width.
#import "lib/environment.wgsl"
#import "lib/repeat_sampler.wgsl"

const ENVIRONMENT_TURN: f32 = 6.2831853;

// Linear colour from a unit world direction. Level 0 alone: where the longitude wraps there is no jump to see.
fn environment_from(direction: vec3f) -> vec3f {
    let height = f32(textureDimensions(environment_texture).y);
    let is_pole = abs(direction.x) + abs(direction.y) < 1.0e-12;
    let longitude = atan2(direction.x, select(direction.y, 1.0, is_pole));
    let latitude = acos(clamp(direction.z, -1.0, 1.0));
    // The sampler repeats; the pole's row must not be mixed with that of the other pole.
    let v = clamp(latitude * 2.0 / ENVIRONMENT_TURN, 0.5 / height, 1.0 - 0.5 / height);
    let place = vec2f(0.5 + longitude / ENVIRONMENT_TURN, v);
    return textureSampleLevel(environment_texture, repeat_sampler, place, 0.0).xyz;
}

// Linear colour that a surface mirrors towards the eye, beside what lights give it.
fn environment_reflection(point: SurfacePoint, ray: Ray) -> vec3f {
    let mirrored = normalize(reflect(ray.direction, point.normal));
    return environment_share(point, ray) * environment_from(mirrored);
}
