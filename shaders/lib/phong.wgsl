// Blinn-Phong: what lights make of a material.
#import "lib/lights.wgsl"
#import "lib/material.wgsl"
#import "lib/surface_point.wgsl"
#import slot "environment"
#import slot "labels"
#import slot "material"
#import slot "shadow"

// All lights at a point: what white matter shows of them, and what a highlight of strength 1 does.
struct PhongLight {
    diffuse: vec3f,
    specular: vec3f,
}

// `normal` faces the eye; `is_surface` says that the point is on a surface, which lights behind do not reach, and not
// inside of a volume.
fn phong_light(world: vec3f, normal: vec3f, to_eye: vec3f, shininess: f32, is_surface: bool) -> PhongLight {
    var sum = PhongLight(vec3f(0.0), vec3f(0.0));
    for (var index = 0u; index < params.lights; index++) {
        let light = lights_at(index, world, to_eye);
        let diffuse = dot(normal, light.direction);
        if diffuse > 0.0 {
            let half_way = normalize(light.direction + to_eye + 1.0e-6 * normal);
            let highlight = pow(max(dot(normal, half_way), 0.0), shininess);
            let label = labels_selected();
            let reaches = shadow_transmittance(world, select(vec3f(0.0), normal, is_surface), light, index);
            labels_select(label);
            sum.diffuse += reaches * light.color * diffuse;
            sum.specular += reaches * light.color * highlight;
        }
    }
    return sum;
}

// Linear colour towards the eye of a point of a material.
fn phong_color(material: Material, world: vec3f, normal: vec3f, to_eye: vec3f, is_surface: bool) -> vec3f {
    let light = phong_light(world, normal, to_eye, material.shininess, is_surface);
    return material.ambient + material.diffuse * light.diffuse + material.specular * light.specular;
}

// Linear colour of an opaque surface towards the eye.
fn phong_surface(color: vec3f, point: SurfacePoint, ray: Ray) -> vec3f {
    let material = material_surface(color, point.scalar);
    return phong_color(material, point.world, point.normal, -ray.direction, true) + environment_reflection(point, ray);
}
