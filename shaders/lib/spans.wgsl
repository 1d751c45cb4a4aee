// Spans: the parts of rays that may see anything, for all rays of a tile of pixels together. A tile has a square of texels,
// each texel two spans: world distances from the origins of rays where a span starts and where it ends.
#import "lib/frame.wgsl"

// Texels along a tile's side; of about two pixels each.
const SPANS_SIDE: u32 = 2u;
const SPANS_TEXELS: u32 = 4u;
// Where there is no span.
const SPANS_NONE: vec2f = vec2f(-1.0);

// Texels of the picture: one for every two pixels, rounded, as the node's output has them.
fn spans_size() -> vec2f {
    return max(floor(lens.extent * 0.5 + 0.5), vec2f(1.0));
}

// Tiles of the picture: none where it is too small for any.
fn spans_tiles() -> vec2f {
    return floor(spans_size() / f32(SPANS_SIDE));
}

// Whether there are any: rays of smaller pictures have to find out for themselves.
fn spans_are_known() -> bool {
    return all(spans_tiles() >= vec2f(1.0));
}

// Pixels along the sides of a tile.
fn spans_pixels() -> vec2f {
    return lens.extent / max(spans_tiles(), vec2f(1.0));
}

// The tile of a place in the picture.
fn spans_tile(pixel: vec2f) -> vec2f {
    // A factor that is the same for all pixels: a division is not.
    return min(floor(pixel * (max(spans_tiles(), vec2f(1.0)) / lens.extent)), spans_tiles() - 1.0);
}

// A texel of a tile.
fn spans_texel(tile: vec2f, number: u32) -> vec2f {
    let row = number / SPANS_SIDE;
    return tile * f32(SPANS_SIDE) + vec2f(vec2u(number - row * SPANS_SIDE, row));
}
