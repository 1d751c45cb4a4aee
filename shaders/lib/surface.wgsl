// Points of surfaces: which way they face.
#import "lib/surface_point.wgsl"
#import "lib/volume.wgsl"
#import slot "gradient"

// The world normal, towards the eye, of the volume's surface at a world distance from the entry of a part of a ray:
// of the cut or the face of the box where the part starts there, else from the field's gradient.
fn surface_normal(ray: Ray, distance: f32) -> vec3f {
    if distance <= volume_least() {
        return surface_entry_normal(ray);
    }
    return surface_gradient_normal(ray, distance);
}

fn surface_gradient_normal(ray: Ray, distance: f32) -> vec3f {
    return surface_towards_eye(gradient_at(ray_position(ray, distance)), ray.direction);
}

// The world normal, towards the eye, inside of the volume at a world distance from the entry of a part of a ray; zeros
// where the field is flat. Within a voxel behind a cut it turns from the cut's own normal to the field's: the cut is a
// surface there, whatever the step is.
fn surface_inner_normal(ray: Ray, distance: f32) -> vec3f {
    let facing = surface_inner(ray, distance);
    return facing.direction * facing.per_length;
}

// The same without the division that makes it a unit long.
fn surface_inner(ray: Ray, distance: f32) -> Facing {
    // Shares of the range per voxel: squares of data units may be beyond single floats.
    let share = volume.voxel / max(volume.value_range, 1.0e-37);
    let gradient = gradient_at(ray_position(ray, distance)) * share;
    let square = dot(gradient, gradient);
    // A change of one part in 10^4 of the range per voxel is noise of the storage, not a surface.
    let is_flat = square < 1.0e-8;
    let per_length = inverseSqrt(select(square, 1.0, is_flat));
    let signed = select(per_length, -per_length, dot(gradient, ray.direction) > 0.0);
    let facing = Facing(gradient, select(signed, 0.0, is_flat));
    if any(ray.cut_normal != vec3f(0.0)) && distance < volume.voxel {
        let blend = mix(ray.cut_normal, facing.direction * facing.per_length, distance / volume.voxel);
        return Facing(blend, 1.0 / max(length(blend), 1.0e-6));
    }
    return facing;
}

// The normal of the cut that a part of a ray starts at, or of the face of the box; the field's where it starts at
// neither.
fn surface_entry_normal(ray: Ray) -> vec3f {
    if any(ray.cut_normal != vec3f(0.0)) {
        return ray.cut_normal;
    }
    if !volume_is_at_face(ray) {
        return surface_gradient_normal(ray, 0.0);
    }
    return volume_face_normal(ray);
}

// A unit normal against a direction of sight; where the field is flat, the direction back.
fn surface_towards_eye(given: vec3f, direction: vec3f) -> vec3f {
    let magnitude = length(given);
    if magnitude < 1.0e-20 {
        return -direction;
    }
    return given / select(magnitude, -magnitude, dot(given, direction) > 0.0);
}
