// How much of a light reaches a point: all or nothing, hard shadows of the isosurface.
//
// A ray runs from the point to the light. What it enters from outside casts a shadow; nothing else does. There is no
// offset from the surface that would have to be tuned, for these reasons:
//
// - The ray starts on the isosurface as the field itself has it. The technique's point may lie beside it, by the error of
//   its interpolation, so it is moved along the normal to where the field has the level (two to four samples).
// - It starts in doubt: it is neither outside nor inside. It is outside from the first sample that is farther on the
//   empty side of the level than the device's filter can be wrong by; it is in shadow where such a sample is on the solid
//   side before: then the light is behind the surface as the field has it, whatever a smoothed normal says. Filters
//   weigh with 8 bits of fraction, so they are wrong by 1/256 of what the field changes over a voxel along each axis;
//   the bound is four times that: the start's, the sample's, and as much for rounding. Light that skims along the
//   surface within the bound up to the end of its way arrives.
// - Once outside, every crossing of the level counts, down to the first one. A thin wall right above the surface is not
//   lost: the first segments are 1/16, 1/16, 1/8, 1/4 and 1/2 of a step. Farther away `crossing_next` finds what it can
//   find within a step.
// - On a cut (of a clip, a label, the box) the field has no surface. There the ray starts beside the cut, on its empty
//   side, by twice the length that counts as rounding throughout (`volume_least`), and it starts outside. Parts that a
//   clip leaves are entered like the solid: their faces cast shadows, and what is cut away casts none.
// - A surface that is seen from within its solid (the eye inside, or a cut that is left open) is a sheet: its normal
//   shows into the solid. Then the solid is what is empty, only crossings count, and light enters through a cut.
// - Where the field has no slope to follow (nearest voxels), inside says nothing for the first voxel of the way.
// - Points inside of a volume (without a normal) are in shadow where they are in the solid.
// - A light at the eye reaches what the eye sees.
#import "lib/crossing.wgsl"
#import "lib/isovalue.wgsl"
#import "lib/shadow_ray.wgsl"
#import "lib/shadow_reach.wgsl"
#import slot "clip"

struct ShadowStart {
    world: vec3f,
    // Whether the ray is outside for sure.
    is_free: bool,
    // Whether solid and empty are exchanged.
    is_hollow: bool,
    // A scalar as far from the level is on its side for sure.
    bound: f32,
    // World distance up to which being inside says nothing.
    leaving: f32,
}

// The share of a light, by its number, that reaches a world position. `normal` is the unit world normal of the surface
// that the position is on, zeros inside of a volume.
fn shadow_transmittance(world: vec3f, normal: vec3f, light: Light, index: u32) -> vec3f {
    let is_surface = any(normal != vec3f(0.0));
    if is_surface && lights_is_at_eye(index) {
        return vec3f(1.0);
    }
    var start = ShadowStart(world, true, false, 0.0, 0.0);
    if is_surface {
        start = shadow_start(world, normal);
    }
    let ray = shadow_ray(start.world, light.direction, shadow_reach(world, light, index));
    return vec3f(select(0.0, 1.0, shadow_is_free(start, ray)));
}

// How far a scalar is on the solid side.
fn shadow_inside(scalar: f32) -> f32 {
    let above = scalar - isovalue_level();
    return select(above, -above, params.solid == 1u);
}

fn shadow_inside_at(world: vec3f) -> f32 {
    return shadow_inside(reconstruct_scalar((volume.texture_from_world * vec4f(world, 1.0)).xyz));
}

// Largest distance between two voxels along an axis, in world units.
fn shadow_widest() -> f32 {
    let rows = transpose(mat3x3f(
        volume.texture_from_world[0].xyz,
        volume.texture_from_world[1].xyz,
        volume.texture_from_world[2].xyz,
    ));
    let spacing = 1.0 / (volume.dims * vec3f(length(rows[0]), length(rows[1]), length(rows[2])));
    return max(max(spacing.x, spacing.y), spacing.z);
}

// Whether a surface's point is on a cut: what is in front of it is out of the box, clipped away, or of another label.
fn shadow_is_cut(world: vec3f, normal: vec3f) -> bool {
    let ray = shadow_ray(world + 2.0 * volume_least() * normal, normal, LIGHT_FAR);
    if ray.far <= ray.near || ray.near > 0.0 {
        return true;
    }
    let visible = clip_next(ray);
    if visible.x > 0.0 || visible.y <= visible.x {
        return true;
    }
    return labels_at(ray.entry) != labels_at(ray_position(ray, -4.0 * volume_least()));
}

fn shadow_start(world: vec3f, normal: vec3f) -> ShadowStart {
    if shadow_is_cut(world, normal) {
        return ShadowStart(world + 2.0 * volume_least() * normal, true, false, 0.0, 0.0);
    }
    let aside = 0.25 * volume.voxel * normal;
    let slope = (shadow_inside_at(world + aside) - shadow_inside_at(world - aside)) / (0.5 * volume.voxel);
    // Over all three axes a field changes by at most the root of three times its slope.
    let filtered = sqrt(3.0) / 256.0 * abs(slope) * shadow_widest() + 1.0e-6 * volume.value_range;
    var start = ShadowStart(world, false, slope > 0.0, 4.0 * filtered, 0.0);
    var moved = 0.0;
    for (var turn = 0u; turn < 4u; turn++) {
        let inside = shadow_inside_at(world + moved * normal);
        if abs(inside) <= filtered {
            start.world = world + moved * normal;
            return start;
        }
        moved -= inside / select(slope, -1.0e-20, slope == 0.0);
        if abs(moved) > 0.5 * volume.voxel {
            break;
        }
    }
    start.is_hollow = false;
    start.leaving = volume.voxel;
    return start;
}

// World distance from the entry to the end of segment number `index`; the first step from the surface is taken in
// parts, each twice as long as the last.
fn shadow_end(ray: Ray, index: u32, is_first: bool) -> f32 {
    if !is_first {
        return shadow_segment_end(ray, index);
    }
    if index < 4u {
        return min(exp2(f32(index) - 4.0) * (params.shadow_step * volume.voxel), ray.far - ray.near);
    }
    return shadow_segment_end(ray, index - 4u);
}

// Whether the ray gets to its end.
fn shadow_is_free(given: ShadowStart, ray: Ray) -> bool {
    var start = given;
    var parts = parts_begin(ray);
    var part = ray;
    var seen_to = ray.near;
    for (var number = 0u; number < PARTS_MAX; number++) {
        if !parts_next(&parts, &part) {
            break;
        }
        start.is_free = start.is_free || part.near > seen_to + 2.0 * volume_least();
        seen_to = part.far;
        let length = part.far - part.near;
        var front = shadow_sample(part, 0.0);
        if start.is_free {
            if isovalue_is_solid(front.scalar) != start.is_hollow {
                if !given.is_hollow {
                    return false;
                }
                // Light gets in or out by a cut.
                start.is_hollow = !start.is_hollow;
            }
        }
        var from_entry = 0.0;
        for (var index = 0u; from_entry < length && index < SHADOW_MAX_SEGMENTS; index++) {
            let end = shadow_end(part, index, number == 0u);
            let back = shadow_sample(part, end);
            if start.is_free {
                let segment = segment_between(front, back, from_entry, end - from_entry);
                if crossing_next(part, segment, isovalue_level(), -1.0) != CROSSING_NONE {
                    return false;
                }
            } else {
                let inside = select(shadow_inside(back.scalar), -shadow_inside(back.scalar), start.is_hollow);
                start.is_free = inside < -start.bound;
                if inside > start.bound && part.near + end > start.leaving {
                    return false;
                }
            }
            front = back;
            from_entry = end;
        }
    }
    return true;
}
