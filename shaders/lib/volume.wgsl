// The volume that is read: its box, and its scalars in data units.
#import "lib/ray.wgsl"
#import "lib/volume_texture.wgsl"
#import slot "volumes"
#import slot "volume_filter"
#import slot "volume_texel"

// Clips a ray to the volume's box (the slab method); far <= near where it misses.
fn volume_clip_ray(given: Ray) -> Ray {
    var ray = given;
    let origin = (volume.texture_from_world * vec4f(ray.origin, 1.0)).xyz;
    ray.slope = (volume.texture_from_world * vec4f(ray.direction, 0.0)).xyz;
    // A ray along a face has no crossing with it; a tiny slope keeps the division finite.
    let slope = select(ray.slope, vec3f(1.0e-20), abs(ray.slope) < vec3f(1.0e-20));
    let a = (volume.box_low - origin) / slope;
    let b = (volume.box_high - origin) / slope;
    let first = min(a, b);
    let last = max(a, b);
    ray.near = max(max(max(first.x, first.y), first.z), 0.0);
    ray.far = min(min(last.x, last.y), last.z);
    ray.entry = origin + ray.near * ray.slope;
    return ray;
}

// Whether a ray's entry is on a face of the box, but for rounding.
fn volume_is_at_face(ray: Ray) -> bool {
    let low = abs(ray.entry - volume.box_low) * volume.dims;
    let high = abs(ray.entry - volume.box_high) * volume.dims;
    return any(min(low, high) < vec3f(0.05));
}

// World normal, towards the eye, of the face of the box that is nearest to a ray's entry.
fn volume_face_normal(ray: Ray) -> vec3f {
    let low = abs(ray.entry - volume.box_low) * volume.dims;
    let high = abs(ray.entry - volume.box_high) * volume.dims;
    let near = min(low, high);
    let is_nearest = vec3f(near <= vec3f(min(min(near.x, near.y), near.z)));
    // Rows of texture_from_world are the normals of the faces.
    let normal = transpose(volume.texture_from_world) * vec4f(is_nearest * -sign(ray.slope), 0.0);
    return normalize(normal.xyz);
}

// World distance from a position (texture coordinates) in the box to where it is left along a slope (texture coordinates
// per world unit).
fn volume_exit(position: vec3f, given: vec3f) -> f32 {
    let slope = select(given, vec3f(1.0e-20), abs(given) < vec3f(1.0e-20));
    let last = max((volume.box_low - position) / slope, (volume.box_high - position) / slope);
    return max(min(min(last.x, last.y), last.z), 0.0);
}

// Bends a ray at a world distance from its entry into another world direction (unit). It goes on there; its distances
// go on counting the way that it has come. What is behind it is no longer what is behind its pixel: a technique that
// bends rays lays it under their colour itself (`beyond_color`).
fn volume_bend_ray(ray: ptr<function, Ray>, distance: f32, direction: vec3f) {
    let at = ray_world(*ray, distance);
    let near = (*ray).near + distance;
    var bent = *ray;
    bent.entry = ray_position(*ray, distance);
    bent.direction = direction;
    bent.origin = at - near * direction;
    bent.near = near;
    bent.slope = (volume.texture_from_world * vec4f(direction, 0.0)).xyz;
    bent.far = near + volume_exit(bent.entry, bent.slope);
    bent.cut_normal = vec3f(0.0);
    bent.is_continued = true;
    bent.bends += 1u;
    *ray = bent;
}

// World distances shorter than this are rounding errors: a part of a ray so short would be drawn as a face.
fn volume_least() -> f32 {
    return 1.0e-4 * volume.voxel;
}

// A scalar of a placement, as shaders count them, from one that the user gave in a unit: 0, 0 to 1 over the range of the
// data; 1, over that of the stored type (of floats: of the data); 2, data units.
fn volume_scalar(placement: Volume, given: f32, unit: u32) -> f32 {
    if unit == 0u {
        return placement.value_low + given * placement.value_range;
    }
    let normalised = placement.normalised_low + given * placement.normalised_span;
    return select(normalised, given - placement.value_reference, unit == 2u);
}

// Trilinear scalar in data units.
fn volume_linear(position: vec3f) -> f32 {
    return volume_filter(position) * volume.value_scale + volume.value_offset;
}

// Scalar of the nearest voxel in data units.
fn volume_nearest(position: vec3f) -> f32 {
    return volume_voxel(vec3i(floor(position * volume.dims)));
}

// Scalar of a voxel in data units, the index clamped to the grid.
fn volume_voxel(index: vec3i) -> f32 {
    return volume_texel(index, volume.dims) * volume.value_scale + volume.value_offset;
}
