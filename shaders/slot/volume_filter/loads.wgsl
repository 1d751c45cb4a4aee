// The texel at a point, trilinear: from eight loads, for formats that the device cannot filter.
#import slot "volumes"

fn volume_filter(position: vec3f) -> f32 {
    let last = vec3i(volume.dims) - 1;
    let place = clamp(volumes_place(position) * volume.dims - 0.5, vec3f(0.0), vec3f(last));
    let low = vec3i(place);
    let high = min(low + 1, last);
    let part = place - vec3f(low);
    let x00 = mix(volumes_load(low), volumes_load(vec3i(high.x, low.y, low.z)), part.x);
    let x10 = mix(volumes_load(vec3i(low.x, high.y, low.z)), volumes_load(vec3i(high.x, high.y, low.z)), part.x);
    let x01 = mix(volumes_load(vec3i(low.x, low.y, high.z)), volumes_load(vec3i(high.x, low.y, high.z)), part.x);
    let x11 = mix(volumes_load(vec3i(low.x, high.y, high.z)), volumes_load(high), part.x);
    return mix(mix(x00, x10, part.y), mix(x01, x11, part.y), part.z);
}
