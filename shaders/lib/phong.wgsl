// Blinn-Phong: what lights make of a material.
#import "lib/lights.wgsl"
#import "lib/material.wgsl"
#import slot "labels"
#import slot "shadow"

struct Params {
    /// Sharpness of the highlight. @default 32 @range 1 256
    shininess: f32,
}

// Linear colour towards the eye. `normal` faces the eye; `is_surface` says that the point is on a surface, which lights
// behind do not reach, and not inside of a volume.
fn phong_color(material: Material, world: vec3f, normal: vec3f, to_eye: vec3f, is_surface: bool) -> vec3f {
    var color = material.ambient;
    for (var index = 0u; index < params.lights; index++) {
        let light = lights_at(index, world, to_eye);
        let diffuse = dot(normal, light.direction);
        if diffuse > 0.0 {
            let half_way = normalize(light.direction + to_eye + 1.0e-6 * normal);
            let highlight = pow(max(dot(normal, half_way), 0.0), params.shininess);
            let label = labels_selected();
            let reaches = shadow_transmittance(world, select(vec3f(0.0), normal, is_surface), light, index);
            labels_select(label);
            color += reaches * light.color * (material.diffuse * diffuse + vec3f(material.specular * highlight));
        }
    }
    return color;
}
