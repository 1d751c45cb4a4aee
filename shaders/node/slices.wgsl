// View-aligned slices of a volume, blended in the framebuffer from front to back: with the slot `classify` at `post`, the
// slices of Cabral et al. (1994), at `preintegrated_2d` the slabs between slices of Engel, Kraus and Ertl (2001).
//
// A slab is what lies between two planes across the view. One instance is drawn for each, or for each four (Röttger et al.
// 2003: several steps in a fragment before it is blended): the polygon of the plane in its middle with the volume's box,
// the box a little larger, so that no ray that meets the slab within the box is lost at its outline. The fragment cuts its
// ray with the planes and with the box itself: so lengths are exact for each pixel in perspective, and the slabs at the
// faces of the box are short, not lost.
#import "lib/step.wgsl"
#import "lib/volume.wgsl"
#import "lib/sample.wgsl"
#import slot "slab"
#import slot "behind"

struct Slices {
    // Halves of the box's sides as world vectors, turned so that none points towards the eye: the box's first corner is
    // the middle minus all of them.
    half_x: vec3f,
    half_y: vec3f,
    half_z: vec3f,
    // World distances from the middle to the faces.
    face_distances: vec3f,
    // World distances along the view's axis from the box's middle to the first plane and to the last.
    first: f32,
    last: f32,
    // Slabs of an instance.
    slabs: u32,
    // The length of a ray between two planes that are 1 apart, at most.
    steepest: f32,
}

@group(0) @binding(3) var color_out: texture_storage_2d<rgba32float, write>;
@group(0) @binding(4) var slices: texture_2d<f32>;
@group(0) @binding(8) var<uniform> slabs: Slices;

// World distance along the view's axis from the box's middle to a plane. Never accumulated.
fn slices_plane(index: u32) -> f32 {
    return min(slabs.first + f32(index) * step_world(), slabs.last);
}

struct SlicesVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) first: u32,
}

// Corner `corner` of six of a box that is cut by a plane across the view at `height` (Rezk-Salama and Kolb 2005). Three
// ways of three edges each lead from the first corner of the box to the last, and the plane meets each once: these are
// the even corners. The odd ones are on the edges between two ways, where the plane meets those; else they are where the
// corner before is.
fn slices_corner(corner: u32, x: vec3f, y: vec3f, z: vec3f, height: f32) -> vec3f {
    // The way along a, then b, then c.
    var a = x;
    var b = y;
    var c = z;
    if corner == 2u || corner == 3u {
        a = y;
        b = z;
        c = x;
    } else if corner >= 4u {
        a = z;
        b = x;
        c = y;
    }
    let start = -(a + b + c);
    let heights = dot(start, camera.forward);
    let rise = 2.0 * vec3f(dot(a, camera.forward), dot(b, camera.forward), dot(c, camera.forward));
    let rises = max(rise, vec3f(1.0e-20));
    // The edge from where the next way has its first corner, to where this one has its second.
    if corner % 2u == 1u {
        let part = (height - heights - rise.y) / rises.x;
        if part >= 0.0 && part <= 1.0 {
            return start + 2.0 * (b + part * a);
        }
    }
    let parts = clamp((vec3f(height - heights) - vec3f(0.0, rise.x, rise.x + rise.y)) / rises, vec3f(0.0), vec3f(1.0));
    return start + 2.0 * (parts.x * a + parts.y * b + parts.z * c);
}

@vertex
fn slices_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> SlicesVertex {
    let first = instance * slabs.slabs;
    let front = slices_plane(first);
    let back = slices_plane(first + slabs.slabs);
    let middle = 0.5 * (front + back);
    // Along a ray, what is in the slab is so far from the plane in its middle, and a pixel's width beside it.
    let depth = dot(volume.centre - camera.anchor, camera.forward) + camera.skipped + back;
    let pixel = 2.0 * lens.half_extent.y / lens.size.y * select(depth, 1.0, lens.is_orthographic != 0u);
    let margin = 0.5 * (back - front) * slabs.steepest + pixel;
    let larger = 1.0 + margin / slabs.face_distances;
    // A fan of four triangles.
    let triangle = vertex / 3u;
    let place = vertex % 3u;
    let corner = select(triangle + place, 0u, place == 0u);
    let x = larger.x * slabs.half_x;
    let y = larger.y * slabs.half_y;
    let z = larger.z * slabs.half_z;
    let world = volume.centre + slices_corner(corner, x, y, z, middle);
    return SlicesVertex(frame_clip_from_world(world), first);
}

struct SlicesWalk {
    ray: Ray,
    // World distance along the ray from its origin to the plane through the box's middle, and its length between two
    // planes that are 1 apart.
    middle: f32,
    per_depth: f32,
    seen: Classified,
    front: Sample,
    start: f32,
}

fn slices_begin(pixel: vec2f, first: u32) -> SlicesWalk {
    var walk: SlicesWalk;
    walk.ray = volume_clip_ray(ray_through(pixel));
    walk.ray.far = max(walk.ray.far, walk.ray.near);
    walk.per_depth = 1.0 / dot(walk.ray.direction, camera.forward);
    walk.middle = dot(volume.centre - walk.ray.origin, camera.forward) * walk.per_depth;
    walk.seen = Classified(vec3f(0.0), 1.0);
    walk.start = slices_distance(walk, first);
    walk.front = sample_along(walk.ray, walk.start);
    return walk;
}

// World distance from the ray's entry into the box to a plane, not beyond the box.
fn slices_distance(walk: SlicesWalk, index: u32) -> f32 {
    let distance = walk.middle + slices_plane(index) * walk.per_depth;
    return clamp(distance, walk.ray.near, walk.ray.far) - walk.ray.near;
}

// Adds the slab before a plane.
fn slices_slab(walk: ptr<function, SlicesWalk>, index: u32) {
    let end = slices_distance(*walk, index);
    let back = sample_along((*walk).ray, end);
    let length = end - (*walk).start;
    if length > 0.0 {
        let segment = segment_between((*walk).front, back, (*walk).start, length);
        (*walk).seen = classified_behind((*walk).seen, slab_classify((*walk).ray, segment));
    }
    (*walk).front = back;
    (*walk).start = end;
}

fn slices_color(walk: SlicesWalk) -> vec4f {
    return vec4f(walk.seen.color, 1.0 - walk.seen.transmittance);
}

@fragment
fn slices_fragment(@builtin(position) position: vec4f, @location(0) @interpolate(flat) first: u32) -> @location(0) vec4f {
    var walk = slices_begin(position.xy, first);
    slices_slab(&walk, first + 1u);
    return slices_color(walk);
}

@fragment
fn slices_fragment_4(@builtin(position) position: vec4f, @location(0) @interpolate(flat) first: u32) -> @location(0) vec4f {
    var walk = slices_begin(position.xy, first);
    slices_slab(&walk, first + 1u);
    slices_slab(&walk, first + 2u);
    slices_slab(&walk, first + 3u);
    slices_slab(&walk, first + 4u);
    return slices_color(walk);
}

// All slices over what lies behind them.
@compute @workgroup_size(8, 8, 1)
fn slices_compose(@builtin(global_invocation_id) id: vec3u) {
    if all(vec2f(id.xy) < lens.size) {
        let pixel = vec2i(id.xy);
        let color = textureLoad(slices, pixel, 0);
        textureStore(color_out, pixel, color + (1.0 - color.w) * behind_color(pixel));
    }
}
