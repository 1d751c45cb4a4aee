// What a bent ray sees behind the volume: the picture there, linear between its pixels; its edge goes on to the sides.
#import "lib/behind.wgsl"
#import "lib/frame.wgsl"

// `place` is in the view plane: -1..1 over the height, y up.
fn beyond_at(place: vec2f) -> vec4f {
    let last = vec2f(textureDimensions(behind)) - vec2f(1.0);
    let centred = vec2f(place.x, -place.y) * lens.size.y;
    let at = clamp((centred + lens.size) * 0.5 - 0.5, vec2f(0.0), last);
    let low = floor(at);
    let high = min(low + 1.0, last);
    let part = at - low;
    let top = mix(
        textureLoad(behind, vec2i(low), 0),
        textureLoad(behind, vec2i(vec2f(high.x, low.y)), 0),
        part.x,
    );
    let bottom = mix(
        textureLoad(behind, vec2i(vec2f(low.x, high.y)), 0),
        textureLoad(behind, vec2i(high), 0),
        part.x,
    );
    return mix(top, bottom, part.y);
}
