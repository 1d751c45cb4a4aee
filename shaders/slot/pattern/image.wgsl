// The background: an image, as high as the picture, repeated to the sides.
#import "lib/repeat_sampler.wgsl"

@group(2) @binding(3) var image_texture: texture_2d<f32>;

// `place` is in the view plane: -1..1 over the height, y up.
fn pattern_color(place: vec2f) -> vec4f {
    let size = vec2f(textureDimensions(image_texture));
    let at = vec2f(place.x * size.y / size.x, -place.y) * 0.5 + 0.5;
    return textureSampleLevel(image_texture, repeat_sampler, at, 0.0);
}
