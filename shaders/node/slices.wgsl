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

// What fragments need to know of their rays, the same for all of them: fragments are many, and each does little.
struct SlicesVertex {
    @builtin(position) position: vec4f,
    // The depths of the first planes.
    @location(0) @interpolate(flat) planes: vec4f,
    @location(1) @interpolate(flat) last_plane: f32,
    // Texture coordinates of the ray through the picture's corner where it meets the plane through the box's middle, and
    // their changes per pixel to the right and down.
    @location(2) @interpolate(flat) place: vec3f,
    @location(3) @interpolate(flat) place_right: vec3f,
    @location(4) @interpolate(flat) place_down: vec3f,
    // Their changes per world unit along the view's axis, likewise.
    @location(5) @interpolate(flat) slope: vec3f,
    @location(6) @interpolate(flat) slope_right: vec3f,
    @location(7) @interpolate(flat) slope_down: vec3f,
    // How far the ray goes aside on the way, in view space: at the corner, and per pixel.
    @location(8) @interpolate(flat) aside: vec4f,
    // The box in texture coordinates.
    @location(9) @interpolate(flat) box_low: vec3f,
    @location(10) @interpolate(flat) box_high: vec3f,
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
    var out: SlicesVertex;
    out.position = frame_clip_from_world(world);
    out.planes = vec4f(front, slices_plane(first + 1u), slices_plane(first + 2u), slices_plane(first + 3u));
    out.last_plane = back;
    // World offsets from the view's axis at a depth of 1, or anywhere where rays are parallel.
    let corner_plane = frame_view_plane(-lens.corner) * lens.half_extent.y;
    let corner_aside = corner_plane.x * camera.right + corner_plane.y * camera.up;
    let pixel_size = 2.0 * lens.half_extent.y / lens.size.y;
    let right = pixel_size * camera.right;
    let down = -pixel_size * camera.up;
    let from_anchor = dot(volume.centre - camera.anchor, camera.forward);
    let is_parallel = lens.is_orthographic != 0u;
    let spread = select(camera.skipped + from_anchor, 1.0, is_parallel);
    let axis = camera.anchor + from_anchor * camera.forward;
    out.place = (volume.texture_from_world * vec4f(axis + spread * corner_aside, 1.0)).xyz;
    out.place_right = (volume.texture_from_world * vec4f(spread * right, 0.0)).xyz;
    out.place_down = (volume.texture_from_world * vec4f(spread * down, 0.0)).xyz;
    let opening = select(1.0, 0.0, is_parallel);
    out.slope = (volume.texture_from_world * vec4f(camera.forward + opening * corner_aside, 0.0)).xyz;
    out.slope_right = (volume.texture_from_world * vec4f(opening * right, 0.0)).xyz;
    out.slope_down = (volume.texture_from_world * vec4f(opening * down, 0.0)).xyz;
    out.aside = opening * vec4f(corner_plane, pixel_size, -pixel_size);
    out.box_low = volume.box_low;
    out.box_high = volume.box_high;
    return out;
}

struct SlicesWalk {
    // Its entry is where it meets the plane through the box's middle.
    ray: Ray,
    // The ray's length between two planes that are 1 apart.
    per_depth: f32,
    // Depths where it is in the box.
    near: f32,
    far: f32,
    seen: Classified,
    front: Sample,
    start: f32,
}

fn slices_begin(fragment: SlicesVertex) -> SlicesWalk {
    let pixel = fragment.position.xy + lens.corner;
    var walk: SlicesWalk;
    let aside = fragment.aside.xy + pixel * fragment.aside.zw;
    walk.per_depth = sqrt(1.0 + dot(aside, aside));
    let place = fragment.place + pixel.x * fragment.place_right + pixel.y * fragment.place_down;
    let given = fragment.slope + pixel.x * fragment.slope_right + pixel.y * fragment.slope_down;
    // A ray along a face has no crossing with it; a tiny slope keeps the division finite.
    let slope = select(given, vec3f(1.0e-20), abs(given) < vec3f(1.0e-20));
    let a = (fragment.box_low - place) / slope;
    let b = (fragment.box_high - place) / slope;
    let first = min(a, b);
    let last = max(a, b);
    walk.near = max(max(first.x, first.y), first.z);
    walk.far = max(min(min(last.x, last.y), last.z), walk.near);
    walk.ray = slab_ray(fragment.position.xy, walk.per_depth);
    walk.ray.entry = place;
    walk.ray.slope = given / walk.per_depth;
    walk.seen = Classified(vec3f(0.0), 1.0);
    walk.start = slices_distance(walk, fragment.planes.x);
    walk.front = sample_along(walk.ray, walk.start);
    return walk;
}

// World distance from the ray's entry to a plane, not beyond the box.
fn slices_distance(walk: SlicesWalk, plane: f32) -> f32 {
    return clamp(plane, walk.near, walk.far) * walk.per_depth;
}

// Adds the slab before a plane.
fn slices_slab(walk: ptr<function, SlicesWalk>, plane: f32) {
    let end = slices_distance(*walk, plane);
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
fn slices_fragment(fragment: SlicesVertex) -> @location(0) vec4f {
    var walk = slices_begin(fragment);
    slices_slab(&walk, fragment.last_plane);
    return slices_color(walk);
}

@fragment
fn slices_fragment_4(fragment: SlicesVertex) -> @location(0) vec4f {
    var walk = slices_begin(fragment);
    slices_slab(&walk, fragment.planes.y);
    slices_slab(&walk, fragment.planes.z);
    slices_slab(&walk, fragment.planes.w);
    slices_slab(&walk, fragment.last_plane);
    return slices_color(walk);
}

// All slices over what lies behind them.
@compute @workgroup_size(8, 8, 1)
fn slices_compose(@builtin(global_invocation_id) id: vec3u) {
    if all(vec2f(id.xy) < lens.extent) {
        let pixel = vec2i(id.xy);
        let color = textureLoad(slices, pixel, 0);
        textureStore(color_out, pixel, color + (1.0 - color.w) * behind_color(pixel));
    }
}
