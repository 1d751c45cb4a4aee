// The clip volume's texel at a point, trilinear: from eight loads, for formats that the device cannot filter.
#import "lib/clip_volume_texture.wgsl"

fn clip_volume_filter(position: vec3f) -> f32 {
    let dims = vec3i(textureDimensions(clip_volume_texture));
    let place = clamp(position * vec3f(dims) - 0.5, vec3f(0.0), vec3f(dims - 1));
    let low = vec3i(place);
    let high = min(low + 1, dims - 1);
    let part = place - vec3f(low);
    let near = mix(clip_volume_row(low.x, high.x, low.y, low.z, part.x), clip_volume_row(low.x, high.x, high.y, low.z, part.x), part.y);
    let far = mix(clip_volume_row(low.x, high.x, low.y, high.z, part.x), clip_volume_row(low.x, high.x, high.y, high.z, part.x), part.y);
    return mix(near, far, part.z);
}

fn clip_volume_row(low: i32, high: i32, y: i32, z: i32, part: f32) -> f32 {
    let near = textureLoad(clip_volume_texture, vec3i(low, y, z), 0).x;
    return mix(near, textureLoad(clip_volume_texture, vec3i(high, y, z), 0).x, part);
}
