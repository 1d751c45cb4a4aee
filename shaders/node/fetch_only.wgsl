// The limit of raycasting on a device: the rays, steps and samples of a raycast, and nothing but their sum. A grey of
// `gain` times the sum, in which a scalar counts from 0 to 1 over the range of the data, and each sample for the step's
// length in voxels.
#import "lib/volume.wgsl"
#import "lib/step.wgsl"
#import "lib/proxy.wgsl"

struct Params {
    /// Grey of one voxel's length of the largest scalar. @default 0.01 @range 0 1
    gain: f32,
    /// Most samples of a ray beside that at its exit; at 0 that one alone, for what a frame costs without the others.
    /// @default 65535 @range 0 65535
    samples: u32,
}

@group(0) @binding(3) var color_out: texture_storage_2d<rgba32float, write>;

// The sum of the samples along a ray, of scalars as they count: those that a raycast takes, at the entry, at each whole
// step and at the exit.
fn fetch_only_sum(ray: Ray) -> f32 {
    let length = ray.far - ray.near;
    if length <= 0.0 {
        return 0.0;
    }
    let step = step_world();
    let count = min(u32(ceil(length / step)), params.samples);
    var sum = volume_filter(ray_position(ray, length));
    // Nothing in here but the position, the fetch and the addition.
    for (var index = 0u; index < count; index++) {
        sum += volume_filter(ray_position(ray, f32(index) * step));
    }
    let scalars = sum * volume.value_scale + f32(count + 1u) * (volume.value_offset - volume.value_low);
    return scalars / volume.value_range;
}

fn fetch_only_write(pixel: vec2i, grey: f32) {
    textureStore(color_out, pixel, vec4f(vec3f(grey), 1.0));
}

fn fetch_only_pixel(pixel: vec2f) {
    let sum = fetch_only_sum(volume_clip_ray(ray_through(pixel)));
    fetch_only_write(vec2i(pixel), params.gain * params.step * sum);
}

// Black, for every pixel; rays then overwrite those that they start from.
@compute @workgroup_size(8, 8, 1)
fn fetch_only_begin(@builtin(global_invocation_id) id: vec3u) {
    if all(vec2f(id.xy) < lens.extent) {
        fetch_only_write(vec2i(id.xy), 0.0);
    }
}

@vertex
fn fetch_only_vertex(@location(0) world: vec3f) -> @builtin(position) vec4f {
    return proxy_clip_from_world(world);
}

@fragment
fn fetch_only_fragment(@builtin(position) position: vec4f) {
    fetch_only_pixel(position.xy);
}

@compute @workgroup_size(8, 8, 1)
fn fetch_only_compute(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy + tile.first;
    if all(vec2f(pixel) < lens.extent) {
        fetch_only_pixel(vec2f(pixel) + 0.5);
    }
}
