// The first isosurface that the ray meets, opaque to the eye but not to light: each light is attenuated by the way that
// it goes inside of the solid before it comes to the point (Stegmaier et al. 2005, section 6), by colour, so that thin
// parts glow when they are lit from behind. It lights the surface itself, without the slot `light`.
// @skips isovalue
#import "lib/first_hit.wgsl"
#import slot "light_places"
#import "lib/shadow_ray.wgsl"
#import "lib/surface.wgsl"
#import slot "environment"
#import slot "material"

struct Params {
    /// Linear colour of the isosurface. @default 0.8 0.75 0.65 @range 0 1 @color
    surface_color: vec3f,
    /// How strongly the solid attenuates red, green and blue light: the optical depth of half of the smallest side of the
    /// volume's box, so that it carries over between volumes. @default 2 5 9 @range 0 1000
    attenuation: vec3f,
    /// Share of the light that the surface passes on into all directions, whichever way it faces; the rest is
    /// reflected. @default 0.5 @range 0 1
    scattering: f32,
}

struct TechniqueState {
    color: vec4f,
    depth: f32,
    face: CutFace,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(vec4f(0.0), RAY_NO_DEPTH, cut_face_begin());
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let hit = first_hit((*state).face, *ray, segment);
    (*state).face = hit.face;
    if !hit.is_met {
        return false;
    }
    (*state).color = vec4f(translucency_color(first_hit_point(hit.point, *ray), *ray), 1.0);
    (*state).depth = hit.depth;
    return true;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return RayResult(state.color, state.depth);
}

// Linear colour towards the eye.
fn translucency_color(point: SurfacePoint, ray: Ray) -> vec3f {
    let material = material_surface(params.surface_color, point.scalar);
    var color = material.ambient + environment_reflection(point, ray);
    for (var index = 0u; index < params.lights; index++) {
        let light = lights_at(index, point.world, -ray.direction);
        // What the eye sees, a light there reaches from outside.
        var inside = 0.0;
        if !lights_is_at_eye(index) {
            inside = translucency_inside(shadow_ray(point.world, light.direction, light.distance));
        }
        let arrives = light.color * exp(-params.attenuation * (inside / volume.half_side));
        let facing = max(dot(point.normal, light.direction), 0.0);
        let half_way = normalize(light.direction - ray.direction + 1.0e-6 * point.normal);
        let highlight = pow(max(dot(point.normal, half_way), 0.0), material.shininess);
        let reflected = material.diffuse * facing + select(0.0, material.specular * highlight, facing > 0.0);
        color += arrives * mix(reflected, material.diffuse, params.scattering);
    }
    return color;
}

// World length of a ray's way inside of the solid: through all of it, cut where the field crosses the level.
fn translucency_inside(ray: Ray) -> f32 {
    let label = labels_selected();
    var parts = parts_begin(ray);
    var part = ray;
    var inside = 0.0;
    for (var number = 0u; number < PARTS_MAX; number++) {
        if !parts_next(&parts, &part) {
            break;
        }
        let length = part.far - part.near;
        var front = shadow_sample(part, 0.0);
        var start = 0.0;
        for (var index = 0u; start < length && index < SHADOW_MAX_SEGMENTS; index++) {
            let end = shadow_segment_end(part, index);
            let back = shadow_sample(part, end);
            inside += translucency_segment(part, segment_between(front, back, start, end - start));
            front = back;
            start = end;
        }
    }
    labels_select(label);
    return inside;
}

// World length of a segment inside of the solid. Along a segment the field crosses a level a few times at most.
fn translucency_segment(ray: Ray, segment: Segment) -> f32 {
    var inside = 0.0;
    // As its crossings count: a sample on the surface may lie on either side.
    var is_solid = crossing_starts_above(ray, segment, isovalue_level()) != (params.solid == 1u);
    var from_entry = segment.start;
    var after = -1.0;
    for (var turn = 0u; turn < 6u; turn++) {
        let crossing = crossing_next(ray, segment, isovalue_level(), after);
        if crossing == CROSSING_NONE {
            break;
        }
        inside += select(0.0, crossing - from_entry, is_solid);
        is_solid = !is_solid;
        from_entry = crossing;
        after = crossing;
    }
    let end = segment.start + segment.length;
    return inside + select(0.0, end - from_entry, is_solid);
}
