// Raycasting of several volumes in one pass: where they overlap, all of them emit and absorb at once.
//
// The ray is cut where a volume begins or ends. Between two cuts the same volumes are met, and segments are as long as
// the finest of them asks for; they end early at the faces of voxels of volumes whose scalars hold for whole voxels, so
// that such segments are exact. In a segment each volume is classified alone; together their extinctions add up, and
// each emits in proportion to its own (Max 1995).
#import "lib/volume.wgsl"
#import "lib/compositing.wgsl"
#import "lib/proxy.wgsl"
#import "lib/sample.wgsl"
#import "lib/shown.wgsl"
#import "lib/step.wgsl"
#import "lib/transfer.wgsl"
#import slot "classify"
#import slot "light"
#import slot "behind"
#import slot "depth_layer"
#import slot "opacity_layer"
#import slot "samples_layer"

@group(0) @binding(3) var color_out: texture_storage_2d<rgba32float, write>;

const MULTIVOLUME_MAX_SEGMENTS: u32 = 65535u;

// The way of a ray through a volume's box: world distances from the ray's origin, and texture coordinates.
struct Track {
    near: f32,
    far: f32,
    entry: vec3f,
    slope: vec3f,
}

// A volume's extinction by its opacity: what an opacity must be multiplied with, 1 for the thinnest.
fn multivolume_thickness(opacity: f32) -> f32 {
    // The logarithm of what is almost 1 has few digits.
    if opacity < 0.02 {
        return 1.0 + opacity * (0.5 + opacity * (1.0 / 3.0 + opacity * 0.25));
    }
    return -log(max(1.0 - opacity, 1.0e-30)) / opacity;
}

// World distance from the ray's origin to where the voxel is left that a track is in right behind a distance.
fn multivolume_voxel_end(track: Track, distance: f32, least: f32) -> f32 {
    let slope = track.slope * volume.dims;
    let entry = track.entry * volume.dims;
    let inside = entry + (distance + least - track.near) * slope;
    let face = select(ceil(inside) - 1.0, floor(inside) + 1.0, slope > vec3f(0.0));
    let is_along = abs(slope) < vec3f(1.0e-12);
    let ends = select((face - entry) / select(slope, vec3f(1.0), is_along), vec3f(RAY_NO_DEPTH), is_along);
    return max(track.near + min(min(ends.x, ends.y), ends.z), distance + least);
}

// Reads a volume and its transfer function from here on.
fn multivolume_select(index: u32) {
    volumes_select(index);
    transfer_select(index);
}

fn multivolume_pixel(pixel: vec2f) -> Shown {
    let through = ray_through(pixel);
    var tracks: array<Track, VOLUMES_COUNT>;
    var at = RAY_NO_DEPTH;
    var far = 0.0;
    var least = RAY_NO_DEPTH;
    for (var index = 0u; index < VOLUMES_COUNT; index++) {
        volumes_select(index);
        let ray = volume_clip_ray(through);
        tracks[index] = Track(ray.near, ray.far, ray.entry, ray.slope);
        least = min(least, volume_least());
        if ray.far > ray.near {
            at = min(at, ray.near);
            far = max(far, ray.far);
        }
    }
    var whole = through;
    whole.near = 0.0;
    whole.far = far;
    var composite = compositing_begin();
    var samples = 0u;
    for (var cut = 0u; cut < 2u * VOLUMES_COUNT && at < far && !compositing_is_done(composite); cut++) {
        // Where the next volume begins or ends, and the shortest step of those that are met before.
        var next = far;
        for (var index = 0u; index < VOLUMES_COUNT; index++) {
            let track = tracks[index];
            if track.far > track.near {
                next = min(next, select(far, track.near, track.near > at + least));
                next = min(next, select(far, track.far, track.far > at + least));
            }
        }
        let middle = 0.5 * (at + next);
        var step = RAY_NO_DEPTH;
        var fronts: array<Sample, VOLUMES_COUNT>;
        for (var index = 0u; index < VOLUMES_COUNT; index++) {
            let track = tracks[index];
            if track.near < middle && middle < track.far {
                volumes_select(index);
                step = min(step, step_world());
                fronts[index] = multivolume_sample(track, at);
                samples++;
            }
        }
        var start = at;
        var steps = 0u;
        for (var turn = 0u; turn < MULTIVOLUME_MAX_SEGMENTS; turn++) {
            if start >= next || step >= RAY_NO_DEPTH || compositing_is_done(composite) {
                break;
            }
            let step_end = min(at + f32(steps + 1u) * step, next);
            var end = step_end;
            for (var index = 0u; index < VOLUMES_COUNT; index++) {
                let track = tracks[index];
                if volumes_is_nearest(index) && track.near < middle && middle < track.far {
                    volumes_select(index);
                    end = min(end, multivolume_voxel_end(track, start, least));
                }
            }
            // What would be left of the step is no segment of its own.
            if end + least >= step_end {
                end = step_end;
                steps++;
            }
            var transmittance = 1.0;
            var emission = vec3f(0.0);
            for (var index = 0u; index < VOLUMES_COUNT; index++) {
                let track = tracks[index];
                if !(track.near < middle && middle < track.far) {
                    continue;
                }
                multivolume_select(index);
                let is_nearest = volumes_is_nearest(index);
                var front = fronts[index];
                var back = front;
                if is_nearest {
                    front = multivolume_sample(track, 0.5 * (start + end));
                    back = front;
                } else {
                    back = multivolume_sample(track, end);
                    fronts[index] = back;
                }
                samples++;
                var ray = through;
                ray.near = track.near;
                ray.far = track.far;
                ray.entry = track.entry;
                ray.slope = track.slope;
                let segment = segment_between(front, back, start - track.near, end - start);
                let classified = classify_segment(ray, segment);
                if classified.transmittance < 1.0 {
                    var color = classified.color;
                    if !is_nearest {
                        color = light_segment(classified, segment, ray);
                    }
                    emission += color * multivolume_thickness(1.0 - classified.transmittance);
                    transmittance *= classified.transmittance;
                }
            }
            if transmittance < 1.0 {
                let color = emission / multivolume_thickness(1.0 - transmittance);
                let segment = segment_between(fronts[0], fronts[0], start, end - start);
                composite = compositing_segment(composite, whole, segment, color, transmittance);
            }
            start = end;
        }
        at = next;
    }
    return Shown(compositing_result(composite), whole, samples, 0.0);
}

// The sample of the selected volume at a world distance from the ray's origin.
fn multivolume_sample(track: Track, distance: f32) -> Sample {
    let position = track.entry + (distance - track.near) * track.slope;
    return Sample(position, reconstruct_scalar(position));
}

fn multivolume_write(shown: Shown, pixel: vec2i) {
    let color = shown.result.color;
    textureStore(color_out, pixel, color + (1.0 - color.w) * behind_color(pixel));
    depth_layer(shown, pixel);
    opacity_layer(shown, pixel);
    samples_layer(shown, pixel);
}

// What lies behind, for every pixel; rays then overwrite those that they start from.
@compute @workgroup_size(8, 8, 1)
fn multivolume_begin(@builtin(global_invocation_id) id: vec3u) {
    if all(vec2f(id.xy) < lens.extent) {
        multivolume_write(shown_nothing(), vec2i(id.xy));
    }
}

@vertex
fn multivolume_vertex(@location(0) world: vec3f) -> @builtin(position) vec4f {
    return proxy_clip_from_world(world);
}

@fragment
fn multivolume_fragment(@builtin(position) position: vec4f) {
    multivolume_write(multivolume_pixel(position.xy), vec2i(position.xy));
}

@compute @workgroup_size(8, 8, 1)
fn multivolume_compute(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy + tile.first;
    if all(vec2f(pixel) < lens.extent) {
        multivolume_write(multivolume_pixel(vec2f(pixel) + 0.5), vec2i(pixel));
    }
}
