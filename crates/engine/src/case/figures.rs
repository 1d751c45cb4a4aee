//! What is measured of pictures besides their difference.

use std::collections::BTreeMap;

use volgraph_measure::{Convergence, order};
use volgraph_picture::Picture;

/// Below this root mean square error, f32 is all that two pictures differ by, and no order can be told.
const ROUNDING: f64 = 1e-6;

/// The order of convergence from errors at steps, the coarsest first: the slope of the line that fits the logarithms of
/// those best that [`Convergence`] fits, without rounding and steps that are too coarse. Two points suffice, for a case says
/// itself how often it halves; `None` where fewer are left.
pub(super) fn order_of(points: &[(f64, f64)]) -> Option<f64> {
    let (steps, errors): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    let study = Convergence::of(&steps, &errors, ROUNDING, ROUNDING);
    let (steps, errors): (Vec<f64>, Vec<f64>) =
        study.fitted().map(|it| (it.step, it.error)).unzip();
    order(&steps, &errors)
}

/// Pixels with a colour or opacity that is not finite, or a depth that is not a number.
pub(super) fn not_finite(picture: &Picture) -> usize {
    let is_bad = |at: usize, color: &[f32; 4]| {
        let opacity = picture.opacity.as_ref().and_then(|opacity| opacity.get(at));
        let depth = picture.depth.as_ref().and_then(|depth| depth.get(at));
        color.iter().any(|value| !value.is_finite())
            || opacity.is_some_and(|opacity| !opacity.is_finite())
            || depth.is_some_and(|depth| depth.is_nan())
    };
    let pixels = picture.color.iter().enumerate();
    pixels.filter(|(at, color)| is_bad(*at, color)).count()
}

/// The share of the pixels, 0 to 1, whose colour is not the one that most pixels have.
pub(super) fn seen(picture: &Picture) -> f64 {
    let mut counts: BTreeMap<[u32; 4], usize> = BTreeMap::new();
    for color in &picture.color {
        *counts.entry(color.map(f32::to_bits)).or_default() += 1;
    }
    let most = counts.values().copied().max().unwrap_or_default();
    let pixels = picture.color.len().max(1);
    (pixels - most) as f64 / pixels as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_the_slope_of_the_errors_that_a_study_fits() {
        let rounded = |errors: &[f64]| {
            let steps = (0..errors.len()).map(|halvings| 0.5_f64.powi(halvings as i32));
            let points: Vec<(f64, f64)> = steps.zip(errors.iter().copied()).collect();
            order_of(&points).map(|order| (order * 1e6).round() / 1e6)
        };
        assert_eq!(rounded(&[0.4, 0.1]), Some(2.0));
        assert_eq!(rounded(&[0.4, 0.2, 0.1, 0.05]), Some(1.0));
        // Rounding is left out, and all after it.
        assert_eq!(rounded(&[0.4, 0.1, 1e-7, 0.1]), Some(2.0));
        // A first step that is too coarse is left out as well.
        assert_eq!(rounded(&[0.41, 0.4, 0.1, 0.025]), Some(2.0));
        assert_eq!(rounded(&[0.1, 0.4]), Some(-2.0));
        for none in [&[0.4][..], &[0.4, 1e-7], &[]] {
            assert_eq!(rounded(none), None);
        }
    }

    #[test]
    fn whatever_is_not_a_number_is_counted_once_a_pixel() {
        let mut picture = Picture::from_color(2, 2, vec![[0.0, 0.5, 2.0, 1.0]; 4]).unwrap();
        picture.depth = Some(vec![f32::INFINITY; 4]);
        picture.opacity = Some(vec![0.0; 4]);
        assert_eq!(not_finite(&picture), 0);
        picture.color[0] = [f32::NAN, f32::INFINITY, 0.0, 0.0];
        picture.depth = Some(vec![1.0, f32::NAN, 1.0, 1.0]);
        picture.opacity = Some(vec![f32::NAN, 0.0, f32::INFINITY, 0.0]);
        assert_eq!(not_finite(&picture), 3);
        picture.opacity = None;
        assert_eq!(not_finite(&picture), 2);
        picture.depth = None;
        assert_eq!(not_finite(&picture), 1);
    }
}
