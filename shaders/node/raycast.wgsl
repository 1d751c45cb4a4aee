// Single-pass raycasting (Stegmaier et al. 2005): one walk per pixel through the volume's box, segment by segment.
// The walk is here; what a segment means is the technique's. The same walk runs as a fragment shader over the proxy
// geometry and as a compute shader over the pixels that it covers.
#import "lib/volume.wgsl"
#import slot "reconstruct"
#import slot "traverse"
#import slot "technique"
#import slot "behind"

// The first pixel of the rectangle that a compute dispatch covers.
struct Tile {
    first: vec2u,
}

@group(0) @binding(3) var color_out: texture_storage_2d<rgba32float, write>;
@group(0) @binding(4) var depth_out: texture_storage_2d<r32float, write>;
@group(0) @binding(5) var opacity_out: texture_storage_2d<r32float, write>;
@group(0) @binding(6) var<uniform> tile: Tile;

fn raycast_sample(ray: Ray, distance: f32) -> Sample {
    let position = ray_position(ray, distance);
    return Sample(position, reconstruct_scalar(position));
}

// Whatever a `traverse` slot says, a walk ends. Software drivers end every loop after as many turns.
const RAYCAST_MAX_SEGMENTS: u32 = 65535u;

fn raycast_pixel(pixel: vec2f) -> RayResult {
    var ray = volume_clip_ray(ray_through(pixel));
    let length = ray.far - ray.near;
    var state = technique_begin(ray);
    var front = raycast_sample(ray, 0.0);
    var start = 0.0;
    for (var index = 0u; start < length && index < RAYCAST_MAX_SEGMENTS; index++) {
        let end = traverse_segment_end(ray, index);
        let back = raycast_sample(ray, end);
        if technique_segment(&state, &ray, Segment(front, back, start, end - start)) {
            break;
        }
        front = back;
        start = end;
    }
    return technique_finish(state, ray);
}

fn raycast_write_color(result: RayResult, pixel: vec2i) {
    textureStore(color_out, pixel, result.color + (1.0 - result.color.w) * behind_color(pixel));
}

fn raycast_write_layers(result: RayResult, pixel: vec2i) {
    textureStore(depth_out, pixel, vec4f(result.depth));
    textureStore(opacity_out, pixel, vec4f(result.color.w));
}

// What lies behind, for every pixel; rays then overwrite those that they start from.
@compute @workgroup_size(8, 8, 1)
fn raycast_begin(@builtin(global_invocation_id) id: vec3u) {
    if all(vec2f(id.xy) < lens.size) {
        raycast_write_color(ray_nothing(), vec2i(id.xy));
    }
}

@compute @workgroup_size(8, 8, 1)
fn raycast_begin_layers(@builtin(global_invocation_id) id: vec3u) {
    if all(vec2f(id.xy) < lens.size) {
        raycast_write_color(ray_nothing(), vec2i(id.xy));
        raycast_write_layers(ray_nothing(), vec2i(id.xy));
    }
}

// The proxy box, drawn a little larger than it is: rasterisers place corners on a grid of parts of a pixel, and no
// ray that meets the box may be lost at its outline. Rays beside the box find that out themselves.
@vertex
fn raycast_vertex(@location(0) world: vec3f) -> @builtin(position) vec4f {
    let distance = select(length(volume.centre - camera.eye) + volume.radius, 1.0, lens.is_orthographic != 0u);
    let pixel = 2.0 * lens.half_extent.y / lens.size.y * distance;
    let larger = 1.0 + 2.0 * pixel / volume.half_side;
    return frame_clip_from_world(volume.centre + (world - volume.centre) * larger);
}

@fragment
fn raycast_fragment(@builtin(position) position: vec4f) {
    raycast_write_color(raycast_pixel(position.xy), vec2i(position.xy));
}

@fragment
fn raycast_fragment_layers(@builtin(position) position: vec4f) {
    let result = raycast_pixel(position.xy);
    raycast_write_color(result, vec2i(position.xy));
    raycast_write_layers(result, vec2i(position.xy));
}

@compute @workgroup_size(8, 8, 1)
fn raycast_compute(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy + tile.first;
    if all(vec2f(pixel) < lens.size) {
        raycast_write_color(raycast_pixel(vec2f(pixel) + 0.5), vec2i(pixel));
    }
}

@compute @workgroup_size(8, 8, 1)
fn raycast_compute_layers(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy + tile.first;
    if all(vec2f(pixel) < lens.size) {
        let result = raycast_pixel(vec2f(pixel) + 0.5);
        raycast_write_color(result, vec2i(pixel));
        raycast_write_layers(result, vec2i(pixel));
    }
}
