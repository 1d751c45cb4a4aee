// A solid of glass: rays are refracted by Snell's law, and split by Fresnel's equations, where they cross the isosurface,
// a cut or a face of the volume's box; inside they lose light by colour (Beer-Lambert). The reflected share shows what is
// behind in its direction, and is followed only where all of the light is reflected.
#import "lib/beyond.wgsl"
#import "lib/crossing.wgsl"
#import "lib/isovalue.wgsl"
#import slot "parts"
#import "lib/surface.wgsl"
#import slot "clip"
#import slot "light"

struct Params {
    /// Refractive index of the solid; around it is 1. @default 1.5 @range 1 4
    refractive_index: f32,
    /// Linear share of the light that is left after `transmission_length` through the solid.
    /// @default 0.8 0.93 0.9 @range 0 1 @color
    transmission_color: vec3f,
    /// The way through the solid that `transmission_color` holds for, in halves of the box's smallest side.
    /// @default 1 @range 0.001 1000
    transmission_length: f32,
    /// How often a ray may meet the surface; then what is left of its light shows what is behind in its direction.
    /// @default 12 @range 1 64
    max_interfaces: u32,
}

struct TechniqueState {
    color: vec3f,
    // What is left of the light, by colour.
    share: vec3f,
    depth: f32,
    // World distances from the origin up to which the ray has been looked at, and to where it last met the surface.
    seen: f32,
    met: f32,
    interfaces: u32,
    // Which side of the surface the ray is on. The surface that it has just left cannot be met again, however the scalar
    // there is rounded: that crossing leads to the side where the ray is already.
    is_inside: bool,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(vec3f(0.0), vec3f(1.0), RAY_NO_DEPTH, -RAY_NO_DEPTH, 0.0, 0u, false);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let bends = (*ray).bends;
    let end = segment.start + segment.length;
    var is_entering = false;
    // Where a ray comes into what is visible of the volume, and not only goes on in it.
    if segment.start == 0.0 && (*ray).near > (*state).seen + volume_least() {
        let is_solid = isovalue_is_solid(segment.front.scalar);
        // The eye itself may be in the solid.
        (*state).is_inside = is_solid && (*ray).near == 0.0;
        is_entering = is_solid && !(*state).is_inside;
    }
    var after = -1.0;
    for (var turn = 0u; turn < 16u; turn++) {
        var distance = 0.0;
        var normal = vec3f(0.0);
        if is_entering {
            normal = surface_entry_normal(*ray);
            is_entering = false;
        } else if after < end {
            distance = technique_crossing(*ray, segment, after, (*state).is_inside);
            after = distance;
            if distance == CROSSING_NONE {
                // A ray along the surface may be on the other side without having met it.
                if isovalue_is_solid(segment.back.scalar) != (*state).is_inside {
                    technique_absorb(state, (*ray).near + segment.start);
                    (*state).is_inside = !(*state).is_inside;
                }
                (*state).seen = (*ray).near + end;
                if !(*state).is_inside || (*state).seen + volume_least() < (*ray).visible_end {
                    return false;
                }
                if parts_go_on(*ray, end) {
                    return false;
                }
                distance = end;
                normal = technique_exit_normal(*ray, end);
            } else {
                normal = gradient_at(ray_position(*ray, distance));
            }
        } else {
            return false;
        }
        if technique_meet(state, ray, distance, normal) {
            return true;
        }
        if (*ray).bends != bends {
            return false;
        }
    }
    return false;
}

// World distance from the ray's entry to the first crossing in the segment, farther than `given`, that leads to the other
// side than the ray is on; CROSSING_NONE where there is none.
fn technique_crossing(ray: Ray, segment: Segment, given: f32, is_inside: bool) -> f32 {
    var distance = crossing_next(ray, segment, isovalue_level(), given);
    for (var turn = 0u; turn < 16u && distance != CROSSING_NONE; turn++) {
        let next = crossing_next(ray, segment, isovalue_level(), distance);
        var scalar = segment.back.scalar;
        if next != CROSSING_NONE {
            scalar = reconstruct_scalar(ray_position(ray, 0.5 * (distance + next)));
        }
        if isovalue_is_solid(scalar) != is_inside {
            break;
        }
        distance = next;
    }
    return distance;
}

// World normal of the face of the box, or of the cut, where the ray leaves what is visible.
fn technique_exit_normal(ray: Ray, distance: f32) -> vec3f {
    let exit = ray_between(ray, distance, distance);
    if volume_exit(exit.entry, exit.slope) <= volume_least() {
        return volume_face_normal(exit);
    }
    return clip_normal(ray, distance);
}

// Takes what the solid absorbs up to a world distance from the origin.
fn technique_absorb(state: ptr<function, TechniqueState>, distance: f32) {
    if (*state).is_inside {
        let way = (distance - (*state).met) / (params.transmission_length * volume.half_side);
        (*state).share *= exp2(log2(max(params.transmission_color, vec3f(1.0e-6))) * way);
    }
    (*state).met = distance;
}

// The ray meets the surface; true where it has met it often enough. `given` is the normal, of either side.
fn technique_meet(
    state: ptr<function, TechniqueState>,
    ray: ptr<function, Ray>,
    distance: f32,
    given: vec3f,
) -> bool {
    technique_absorb(state, (*ray).near + distance);
    (*state).seen = (*ray).near + distance;
    (*state).interfaces += 1u;
    if (*state).depth == RAY_NO_DEPTH {
        (*state).depth = (*ray).near + distance;
    }
    let direction = (*ray).direction;
    let normal = surface_towards_eye(given, direction);
    let world = ray_world(*ray, distance);
    let is_last = (*state).interfaces >= params.max_interfaces;
    // Index before the surface over the one behind it; angles are those to the normal.
    let ratio = select(1.0 / params.refractive_index, params.refractive_index, (*state).is_inside);
    let cosine = min(-dot(normal, direction), 1.0);
    let reflected = normalize(direction + 2.0 * cosine * normal);
    let square = ratio * ratio * (1.0 - cosine * cosine);
    if square >= 1.0 {
        // Total reflection.
        volume_bend_ray(ray, distance, reflected);
        return is_last;
    }
    if !(*state).is_inside {
        let point = SurfacePoint(world, ray_position(*ray, distance), normal, isovalue_level());
        (*state).color += (*state).share * light_surface(vec3f(0.0), point, *ray);
    }
    (*state).is_inside = !(*state).is_inside;
    // Without a change of the index nothing is reflected, and nothing bent.
    if ratio == 1.0 {
        return is_last;
    }
    let refracted_cosine = sqrt(1.0 - square);
    // Fresnel's equations, the mean of both polarisations.
    let across = (ratio * cosine - refracted_cosine) / (ratio * cosine + refracted_cosine);
    let within = (cosine - ratio * refracted_cosine) / (cosine + ratio * refracted_cosine);
    let reflectance = 0.5 * (across * across + within * within);
    (*state).color += reflectance * (*state).share * beyond_color(world, reflected).xyz;
    (*state).share *= 1.0 - reflectance;
    let refracted = ratio * direction + (ratio * cosine - refracted_cosine) * normal;
    volume_bend_ray(ray, distance, normalize(refracted));
    return is_last;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    let least = min(min(state.share.x, state.share.y), state.share.z);
    let most = max(max(state.share.x, state.share.y), state.share.z);
    let is_straight = ray.bends == 0u;
    if is_straight && least == most {
        return RayResult(vec4f(state.color, 1.0 - most), state.depth);
    }
    let beyond = beyond_color(ray_world(ray, 0.0), ray.direction);
    if is_straight {
        // What is straight behind is added to it by its opacity; here is what its colours have more than that.
        return RayResult(vec4f(state.color + (state.share - least) * beyond.xyz, 1.0 - least), state.depth);
    }
    return RayResult(vec4f(state.color + state.share * beyond.xyz, 1.0 - most + most * beyond.w), state.depth);
}
