// Raycasting in many passes (Röttger et al. 2003, appendix), for devices whose shaders cannot loop: each pass goes some
// segments on along every ray, from the colour and the place that the pass before has left in float textures into another
// pair of them. Slots are those of the raycast, and so is the picture.
//
// After every few passes a termination pass makes a new list of the rays that are not done; passes run for those on the
// list alone. The paper masks rays in the depth buffer instead. Here shaders are guarded and may write what went wrong to
// memory at any time: depth would be compared after them, and nothing saved. A list also leaves no gaps between rays.
#import "lib/compositing.wgsl"
#import "lib/sample.wgsl"
#import "lib/volume.wgsl"
#import slot "classify"
#import slot "traverse"
#import slot "behind"

struct Params {
    /// How many segments a pass goes on along each ray. @default 4 @range 1 64
    steps_per_pass: u32,
}

// Two lists of pixels, one after the other: x in the lower 16 bits, y in the upper ones.
struct Rays {
    // Where the list starts that passes run for, and how long it is.
    first: u32,
    count: u32,
    // How long the other one is that is being made.
    next: atomic<u32>,
    unused: u32,
    pixels: array<u32>,
}

struct Workgroups {
    count: vec3u,
}

@group(0) @binding(3) var color_out: texture_storage_2d<rgba32float, write>;
@group(0) @binding(4) var<storage, read_write> rays_out: Rays;
@group(0) @binding(5) var<storage, read_write> workgroups_out: Workgroups;
// Premultiplied colour and transmittance, and the place along the ray: the number of the next segment, or -1 at its end.
// Steps of other lengths would count in segments of the longest.
@group(3) @binding(10) var light_even: texture_2d<f32>;
@group(3) @binding(11) var light_odd: texture_2d<f32>;
@group(3) @binding(12) var place_even: texture_2d<f32>;
@group(3) @binding(13) var place_odd: texture_2d<f32>;
@group(3) @binding(14) var light_even_out: texture_storage_2d<rgba32float, write>;
@group(3) @binding(15) var light_odd_out: texture_storage_2d<rgba32float, write>;
@group(3) @binding(16) var place_even_out: texture_storage_2d<r32float, write>;
@group(3) @binding(17) var place_odd_out: texture_storage_2d<r32float, write>;

const MULTIPASS_DONE: f32 = -1.0;
// Workgroups in a row: devices have a limit for each axis.
const MULTIPASS_ROW: u32 = 1024u;
const MULTIPASS_GROUP: u32 = 64u;

struct Progress {
    seen: Classified,
    place: f32,
}

// Where the other list starts.
fn multipass_other() -> u32 {
    return arrayLength(&rays_out.pixels) / 2u - rays_out.first;
}

fn multipass_append(pixel: vec2u) {
    let at = atomicAdd(&rays_out.next, 1u);
    rays_out.pixels[multipass_other() + at] = pixel.x | (pixel.y << 16u);
}

// The number of an invocation among those of a pass over the list.
fn multipass_number(group: vec3u, local: u32) -> u32 {
    return (group.y * MULTIPASS_ROW + group.x) * MULTIPASS_GROUP + local;
}

fn multipass_pixel(number: u32) -> vec2u {
    let packed = rays_out.pixels[rays_out.first + number];
    return vec2u(packed & 0xffffu, packed >> 16u);
}

// Empty lists.
@compute @workgroup_size(1)
fn multipass_reset() {
    rays_out.first = 0u;
    rays_out.count = 0u;
    atomicStore(&rays_out.next, 0u);
}

// What lies behind, for every pixel; and a list of the rays that meet the box.
@compute @workgroup_size(8, 8, 1)
fn multipass_begin(@builtin(global_invocation_id) id: vec3u) {
    if any(vec2f(id.xy) >= lens.extent) {
        return;
    }
    let pixel = vec2i(id.xy);
    textureStore(color_out, pixel, behind_color(pixel));
    let ray = volume_clip_ray(ray_through(vec2f(id.xy) + 0.5));
    if ray.far - ray.near > volume_least() {
        textureStore(light_even_out, pixel, vec4f(0.0, 0.0, 0.0, 1.0));
        textureStore(place_even_out, pixel, vec4f(0.0));
        multipass_append(id.xy);
    }
}

// The list that has been made becomes the one that passes run for.
@compute @workgroup_size(1)
fn multipass_settle() {
    let count = atomicLoad(&rays_out.next);
    rays_out.first = multipass_other();
    rays_out.count = count;
    atomicStore(&rays_out.next, 0u);
    let groups = (count + MULTIPASS_GROUP - 1u) / MULTIPASS_GROUP;
    workgroups_out.count = vec3u(min(groups, MULTIPASS_ROW), (groups + MULTIPASS_ROW - 1u) / MULTIPASS_ROW, 1u);
}

// Some segments on from a place along a pixel's ray.
fn multipass_advance(pixel: vec2u, given: Progress) -> Progress {
    let ray = volume_clip_ray(ray_through(vec2f(pixel) + 0.5));
    let length = ray.far - ray.near;
    var seen = given.seen;
    var index = u32(given.place);
    var start = 0.0;
    if index > 0u {
        start = traverse_segment_end(ray, index - 1u);
    }
    var front = sample_along(ray, start);
    var is_done = false;
    for (var turn = 0u; turn < params.steps_per_pass && !is_done; turn++) {
        let end = traverse_segment_end(ray, index);
        let back = sample_along(ray, end);
        let segment = segment_between(front, back, start, end - start);
        seen = classified_behind(seen, classify_segment(ray, segment));
        is_done = end >= length || seen.transmittance < params.early_termination;
        front = back;
        start = end;
        index++;
    }
    if is_done {
        let at = vec2i(pixel);
        textureStore(color_out, at, vec4f(seen.color, 1.0 - seen.transmittance) + seen.transmittance * behind_color(at));
        return Progress(seen, MULTIPASS_DONE);
    }
    return Progress(seen, f32(index));
}

@compute @workgroup_size(64)
fn multipass_advance_even(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = multipass_number(group, local);
    if number < rays_out.count {
        let pixel = multipass_pixel(number);
        let at = vec2i(pixel);
        let light = textureLoad(light_even, at, 0);
        var progress = Progress(Classified(light.xyz, light.w), textureLoad(place_even, at, 0).x);
        if progress.place >= 0.0 {
            progress = multipass_advance(pixel, progress);
        }
        textureStore(light_odd_out, at, vec4f(progress.seen.color, progress.seen.transmittance));
        textureStore(place_odd_out, at, vec4f(progress.place));
    }
}

@compute @workgroup_size(64)
fn multipass_advance_odd(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = multipass_number(group, local);
    if number < rays_out.count {
        let pixel = multipass_pixel(number);
        let at = vec2i(pixel);
        let light = textureLoad(light_odd, at, 0);
        var progress = Progress(Classified(light.xyz, light.w), textureLoad(place_odd, at, 0).x);
        if progress.place >= 0.0 {
            progress = multipass_advance(pixel, progress);
        }
        textureStore(light_even_out, at, vec4f(progress.seen.color, progress.seen.transmittance));
        textureStore(place_even_out, at, vec4f(progress.place));
    }
}

// Termination: rays that are not done go on to the other list.
@compute @workgroup_size(64)
fn multipass_terminate_even(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = multipass_number(group, local);
    if number < rays_out.count {
        let pixel = multipass_pixel(number);
        if textureLoad(place_even, vec2i(pixel), 0).x >= 0.0 {
            multipass_append(pixel);
        }
    }
}

@compute @workgroup_size(64)
fn multipass_terminate_odd(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = multipass_number(group, local);
    if number < rays_out.count {
        let pixel = multipass_pixel(number);
        if textureLoad(place_odd, vec2i(pixel), 0).x >= 0.0 {
            multipass_append(pixel);
        }
    }
}
