// How a point is lit: Blinn-Phong with one directional light, the gradient as the normal, seen from both sides.
// Where the field is flat there is no surface, and the colour stays as it is.
#import "lib/classified.wgsl"
#import "lib/volume.wgsl"
#import slot "gradient"

struct Params {
    /// Share of the colour that needs no light. @default 0.3 @range 0 1
    ambient: f32,
    /// Share of the colour that the light gives. @default 0.7 @range 0 1
    diffuse: f32,
    /// Strength of the highlight. @default 0.25 @range 0 1
    specular: f32,
    /// Sharpness of the highlight. @default 32 @range 1 256
    shininess: f32,
    /// World direction towards the light; all zeros for a light at the eye. @default 0 0 0
    light_direction: vec3f,
}

fn light_segment(classified: Classified, position: vec3f, ray: Ray) -> vec3f {
    let gradient = gradient_at(position);
    let magnitude = length(gradient);
    // A change of one part in 10^4 of the range per voxel is noise of the storage, not a surface.
    let is_flat = magnitude * volume.voxel < 1.0e-4 * volume.value_range;
    let to_eye = -ray.direction;
    let towards = dot(params.light_direction, params.light_direction);
    let to_light = select(to_eye, params.light_direction * inverseSqrt(max(towards, 1.0e-12)), towards > 0.0);
    // The gradient's sign says nothing of which side is seen.
    let normal = gradient / max(magnitude, 1.0e-20);
    let facing = select(-normal, normal, dot(normal, to_eye) > 0.0);
    let half_way = normalize(to_light + to_eye + 1.0e-6 * facing);
    let diffuse = max(dot(facing, to_light), 0.0);
    let highlight = pow(max(dot(facing, half_way), 0.0), params.shininess) * select(0.0, 1.0, diffuse > 0.0);
    let lit = classified.color * (params.ambient + params.diffuse * diffuse)
        + vec3f(params.specular * highlight * (1.0 - classified.transmittance));
    return select(lit, classified.color, is_flat);
}
