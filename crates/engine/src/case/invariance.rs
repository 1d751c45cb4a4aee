//! What a picture must follow: the scene in a mirror, a camera that is rolled, numbers in another type.

pub(super) mod mirrored;
pub(super) mod rolled;
pub(super) mod stored;

use volgraph_measure::compare_without_flip;

use super::outcome::Measured;
use crate::Picture;

/// The error that only a share of the pixels pass, of two pictures: at 0 the largest. `except` is below 1.
pub(super) fn agree(a: &Picture, b: &Picture, max: f64, except: f64) -> Measured {
    if let Err(error) = compare_without_flip(a, b) {
        return Measured::new(false, None, error.to_string());
    }
    let worst = |(a, b): (&[f32; 4], &[f32; 4])| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs())
            .fold(0.0, f64::max)
    };
    let mut errors: Vec<f64> = a.color.iter().zip(&b.color).map(worst).collect();
    errors.sort_by(|a, b| b.total_cmp(a));
    // A share of a picture counts whole pixels, rounded down.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of 0 to 1 of a length"
    )]
    let left_out = (except * errors.len() as f64) as usize;
    // Where all are left out, nothing was held to anything.
    let figure = errors.get(left_out).copied().unwrap_or(f64::INFINITY);
    let mut measured = Measured::at_most("max", figure, max);
    if left_out > 0 {
        measured.detail += &format!(
            " but for {left_out} of {} pixels, where it is {:.3e}",
            errors.len(),
            errors[0]
        );
    }
    measured
}

/// A picture of which each pixel is another one's: `from` gives its column and row.
pub(super) fn moved(picture: &Picture, from: impl Fn(u32, u32) -> [u32; 2]) -> Picture {
    let pixels = (0..picture.height).flat_map(|y| (0..picture.width).map(move |x| (x, y)));
    let color = pixels.map(|(x, y)| {
        let [x, y] = from(x, y);
        picture.pixel(x, y).unwrap_or_default()
    });
    Picture {
        width: picture.width,
        height: picture.height,
        color: color.collect(),
        ..Picture::default()
    }
}
