// The texel at a point, trilinear: from eight loads, for formats that the device cannot filter.
#import "lib/volume_texture.wgsl"

fn volume_filter(position: vec3f) -> f32 {
    let dims = vec3i(textureDimensions(volume_texture));
    let place = clamp(position * vec3f(dims) - 0.5, vec3f(0.0), vec3f(dims - 1));
    let low = vec3i(place);
    let high = min(low + 1, dims - 1);
    let part = place - vec3f(low);
    let x00 = mix(volume_load(low.x, low.y, low.z), volume_load(high.x, low.y, low.z), part.x);
    let x10 = mix(volume_load(low.x, high.y, low.z), volume_load(high.x, high.y, low.z), part.x);
    let x01 = mix(volume_load(low.x, low.y, high.z), volume_load(high.x, low.y, high.z), part.x);
    let x11 = mix(volume_load(low.x, high.y, high.z), volume_load(high.x, high.y, high.z), part.x);
    return mix(mix(x00, x10, part.y), mix(x01, x11, part.y), part.z);
}

fn volume_load(x: i32, y: i32, z: i32) -> f32 {
    return textureLoad(volume_texture, vec3i(x, y, z), 0).x;
}
