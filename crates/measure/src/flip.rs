//! ꟻLIP: the difference that people see when they flip between two pictures on a screen (Andersson et al.,
//! "ꟻLIP: A Difference Evaluator for Alternating Images", 2020), by its authors' own code.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, flip};
use volgraph_picture::Picture;
use volgraph_picture::srgb::srgb_from_linear;

use crate::MeasureError;
use crate::difference::check_pair;

/// Larger pictures get no ꟻLIP: it takes some hundred bytes of memory for each pixel.
pub const MAX_FLIP_PIXELS: usize = 1 << 25;

/// Mean of the LDR-ꟻLIP error map, 0 (equal) to 1, of both pictures over black, clamped to 0..1 and encoded as
/// 8-bit sRGB, seen at 67 pixels per degree; `b` is the reference. `None` above [`MAX_FLIP_PIXELS`].
///
/// # Errors
/// As [`compare`](crate::compare).
pub fn flip_mean(a: &Picture, b: &Picture) -> Result<Option<f64>, MeasureError> {
    check_pair(a, b)?;
    if a.color.len() > MAX_FLIP_PIXELS {
        return Ok(None);
    }
    let map = flip(screen(b), screen(a), DEFAULT_PIXELS_PER_DEGREE).to_vec();
    Ok(Some(
        map.iter().copied().map(f64::from).sum::<f64>() / map.len() as f64,
    ))
}

/// Premultiplied colour over black is the colour itself.
fn screen(picture: &Picture) -> FlipImageRgb8 {
    let codes: Vec<u8> = picture
        .color
        .iter()
        .flat_map(|[r, g, b, _]| [*r, *g, *b])
        .map(|c| (srgb_from_linear(f64::from(c).clamp(0.0, 1.0)) * 255.0).round() as u8)
        .collect();
    FlipImageRgb8::with_data(picture.width, picture.height, &codes)
}
