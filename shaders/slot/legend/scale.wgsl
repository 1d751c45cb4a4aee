// Which legend is drawn into the picture? The bar of its colours with the numbers beside it, at the right. Letters are
// whole pixels, so they stay sharp: the legend grows in steps with the picture. Where it does not fit it is left out.
#import "lib/frame.wgsl"

// The legend twice, side by side: at half its size, and as large as the texture is high.
@group(2) @binding(2) var legend: texture_2d<f32>;

// The picture side that the small one is made for.
const LEGEND_SMALL_PICTURE: i32 = 256;

// Linear premultiplied colour over a pixel.
fn legend_color(pixel: vec2i) -> vec4f {
    let picture = vec2i(lens.size);
    let texels = vec2i(textureDimensions(legend));
    let growth = max(min(picture.x, picture.y) / LEGEND_SMALL_PICTURE, 1);
    let is_large = growth > 1;
    let scale = select(1, growth / 2, is_large);
    let first = vec2i(select(0, texels.x / 3, is_large), 0);
    let extent = select(vec2i(texels.x / 3, texels.y / 2), vec2i(2 * texels.x / 3, texels.y), is_large);
    let shown = extent * scale;
    let margin = vec2i(picture.x - shown.x, (picture.y - shown.y) / 2);
    if any(margin < vec2i(0)) || any(pixel < margin) || any(pixel >= margin + shown) {
        return vec4f(0.0);
    }
    return textureLoad(legend, first + (pixel - margin) / scale, 0);
}
