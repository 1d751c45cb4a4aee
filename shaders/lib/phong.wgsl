// Blinn-Phong: what lights make of a material.
#import "lib/material.wgsl"
#import "lib/surface_point.wgsl"
#import slot "environment"
#import slot "labels"
#import slot "light_places"
#import slot "material"
#import slot "shadow"

// All lights at a point: what white matter shows of them, and what a highlight of strength 1 does.
struct PhongLight {
    diffuse: vec3f,
    specular: vec3f,
}

// `facing` is towards the eye; `is_surface` says that the point is on a surface, which lights behind do not reach, and not
// inside of a volume.
fn phong_light(world: vec3f, facing: Facing, to_eye: vec3f, shininess: f32, is_surface: bool) -> PhongLight {
    var sum = PhongLight(vec3f(0.0), vec3f(0.0));
    // Without a loop numbers of lights are constants, and what is chosen by them is: a frame takes 0.6 of the time on
    // software drivers.
    if params.lights > 0u {
        sum = phong_with(sum, 0u, world, facing, to_eye, shininess, is_surface);
    }
    if params.lights > 1u {
        sum = phong_with(sum, 1u, world, facing, to_eye, shininess, is_surface);
    }
    if params.lights > 2u {
        sum = phong_with(sum, 2u, world, facing, to_eye, shininess, is_surface);
    }
    if params.lights > 3u {
        sum = phong_with(sum, 3u, world, facing, to_eye, shininess, is_surface);
    }
    return sum;
}

// One light more.
fn phong_with(
    before: PhongLight,
    index: u32,
    world: vec3f,
    facing: Facing,
    to_eye: vec3f,
    shininess: f32,
    is_surface: bool,
) -> PhongLight {
    let light = lights_at(index, world, to_eye);
    let normal = facing.direction * facing.per_length;
    let diffuse = max(dot(facing.direction, light.direction) * facing.per_length, 0.0);
    let half_way = lights_half_way(light, to_eye, normal);
    let highlight = pow(max(dot(facing.direction, half_way) * facing.per_length, 0.0), shininess);
    // Nothing but the way to the light is in a branch: without one on it there is none.
    var seen = vec3f(0.0);
    if diffuse > 0.0 {
        let label = labels_selected();
        seen = shadow_transmittance(world, select(vec3f(0.0), normal, is_surface), light, index) * light.color;
        labels_select(label);
    }
    return PhongLight(before.diffuse + seen * diffuse, before.specular + seen * highlight);
}

// Linear colour towards the eye of a point of a material.
fn phong_color(material: Material, world: vec3f, facing: Facing, to_eye: vec3f, is_surface: bool) -> vec3f {
    let light = phong_light(world, facing, to_eye, material.shininess, is_surface);
    return material.ambient + material.diffuse * light.diffuse + material.specular * light.specular;
}

// Linear colour of an opaque surface towards the eye.
fn phong_surface(color: vec3f, point: SurfacePoint, ray: Ray) -> vec3f {
    let material = material_surface(color, point.scalar);
    return phong_color(material, point.world, Facing(point.normal, 1.0), -ray.direction, true) + environment_reflection(point, ray);
}
