// Which part of the ray is visible: that in a box along the volume's own axes, or outside of it.
#import "lib/clip.wgsl"

struct Params {
    /// A corner of the box, in shares of the volume's box along its own axes. @default 0 0 0
    clip_low: vec3f,
    /// The opposite corner. @default 1 1 0.5
    clip_high: vec3f,
}

// Distances where the ray enters and leaves the space between two faces, for each of the three axes.
struct BoxSlabs {
    first: vec3f,
    last: vec3f,
}

fn box_slabs(ray: Ray) -> BoxSlabs {
    let size = volume.box_high - volume.box_low;
    // A ray along a face has no crossing with it; a tiny slope keeps the division finite.
    let slope = select(ray.slope, vec3f(1.0e-20), abs(ray.slope) < vec3f(1.0e-20));
    let a = (volume.box_low + params.clip_low * size - ray.entry) / slope;
    let b = (volume.box_low + params.clip_high * size - ray.entry) / slope;
    return BoxSlabs(min(a, b), max(a, b));
}

// World distances from the ray's entry: where the first visible part starts and ends; the same twice for none.
fn clip_next(ray: Ray) -> vec2f {
    let slabs = box_slabs(ray);
    let first = max(max(slabs.first.x, slabs.first.y), slabs.first.z);
    return clip_part(ray, vec2f(first, min(min(slabs.last.x, slabs.last.y), slabs.last.z)));
}

// World normal, towards the eye, of the cut at a distance from the ray's entry where a visible part starts.
fn clip_normal(ray: Ray, distance: f32) -> vec3f {
    let slabs = box_slabs(ray);
    // The face that is entered last, or left first.
    let times = select(-slabs.first, slabs.last, clip_keeps_outside());
    let is_face = vec3f(times <= vec3f(min(min(times.x, times.y), times.z)));
    // Rows of texture_from_world are the normals of the faces; both normals of an edge turn towards the eye.
    let normal = transpose(volume.texture_from_world) * vec4f(is_face * -sign(ray.slope), 0.0);
    return clip_facing(normal.xyz, ray);
}
