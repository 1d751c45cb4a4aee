// How a point is lit: Blinn-Phong at both ends of a segment, free of rings at large steps (Röttger et al. 2003).
// Between the ends the light is linear, and each end counts as much as what the segment emits is seen near it, by a
// table (Lum, Wilson, Ma 2004). So the light of a thin layer does not jump where the layer passes into the next
// segment, as it does with the light of the centre or with the mean of both ends: order 2 in the step, not 1.
#import "lib/classified.wgsl"
#import "lib/phong.wgsl"
#import "lib/surface.wgsl"
#import slot "material"

// The light at one end of a segment; without a normal where the field is flat.
struct PhongEnd {
    // World distance from the ray's origin, and how often the ray had been bent.
    at: f32,
    bends: u32,
    shininess: f32,
    normal: vec3f,
    light: PhongLight,
}

// The light at the back end of the last segment that was lit: it is the front end's of the next one.
var<private> phong_ends_back: PhongEnd = PhongEnd(-1.0, 0u, 0.0, vec3f(0.0), PhongLight(vec3f(0.0), vec3f(0.0)));

fn phong_ends_at(ray: Ray, distance: f32, normal: vec3f, shininess: f32) -> PhongEnd {
    var end = PhongEnd(ray.near + distance, ray.bends, shininess, normal, PhongLight(vec3f(0.0), vec3f(0.0)));
    if any(normal != vec3f(0.0)) {
        end.light = phong_light(ray_world(ray, distance), Facing(normal, 1.0), -ray.direction, shininess, false);
    }
    return end;
}

// Of the segment before where it ended here and was lit; else anew. A part of a ray starts with a surface of its own.
fn phong_ends_front(ray: Ray, distance: f32, shininess: f32) -> PhongEnd {
    let kept = phong_ends_back;
    let is_here = abs(kept.at - (ray.near + distance)) < volume_least() && kept.bends == ray.bends;
    if !is_here || distance == 0.0 {
        return phong_ends_at(ray, distance, surface_inner_normal(ray, distance), shininess);
    }
    if kept.shininess != shininess {
        return phong_ends_at(ray, distance, kept.normal, shininess);
    }
    return kept;
}

// Linear premultiplied colour of a segment towards the eye.
fn light_segment(classified: Classified, segment: Segment, ray: Ray) -> vec3f {
    let material = material_segment(classified, segment, ray);
    let end = segment.start + segment.length;
    let front = phong_ends_front(ray, segment.start, material.shininess);
    let back = phong_ends_at(ray, end, surface_inner_normal(ray, end), material.shininess);
    phong_ends_back = back;
    let has_front = any(front.normal != vec3f(0.0));
    let has_back = any(back.normal != vec3f(0.0));
    if !has_front && !has_back {
        return classified.color;
    }
    // An end in a flat field has no light of its own.
    var near = back.light;
    var far = front.light;
    if has_front {
        near = front.light;
    }
    if has_back {
        far = back.light;
    }
    let seen_back = material_back(material, classified, segment);
    let diffuse = material.diffuse * near.diffuse + seen_back.diffuse * (far.diffuse - near.diffuse);
    let specular = material.specular * near.specular + seen_back.specular * (far.specular - near.specular);
    return material.ambient + diffuse + specular;
}

// Linear colour of an opaque surface towards the eye.
fn light_surface(color: vec3f, point: SurfacePoint, ray: Ray) -> vec3f {
    return phong_surface(color, point, ray);
}
