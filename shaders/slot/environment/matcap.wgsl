// What a surface mirrors: an image of a lit sphere at the input port `environment`, looked up by the normal as the
// eye sees it. Its middle is for normals towards the eye, the rim of its circle for normals across the view; it turns
// with the camera.
#import "lib/environment.wgsl"
#import "lib/volume_texture.wgsl"

// Linear colour that a surface mirrors towards the eye, beside what lights give it.
fn environment_reflection(point: SurfacePoint, ray: Ray) -> vec3f {
    // Around the ray itself: a sphere shows the whole image wherever in the view it is.
    let aside = normalize(cross(ray.direction, camera.up));
    let above = cross(aside, ray.direction);
    let seen = vec2f(dot(point.normal, aside), -dot(point.normal, above));
    let color = textureSampleLevel(environment_texture, linear_sampler, 0.5 + 0.5 * seen, 0.0).xyz;
    return environment_share(point, ray) * color;
}
