//! What is measured of pictures besides their difference.

use std::collections::BTreeMap;

use volgraph_measure::order;
use volgraph_picture::Picture;

/// Below this root mean square error, f32 is all that two pictures differ by, and no order can be told.
const ROUNDING: f64 = 1e-6;

/// The order of convergence from the errors of one halving after the other: minus the slope of the line that fits
/// their base-2 logarithms best. Errors from the first on that is no more than rounding tell nothing; `None` where fewer
/// than two are left.
pub(super) fn order_of(errors: &[f64]) -> Option<f64> {
    let errors: Vec<f64> = errors
        .iter()
        .copied()
        .take_while(|error| *error > ROUNDING)
        .collect();
    let steps: Vec<f64> = (0..errors.len())
        .map(|halvings| 0.5_f64.powi(halvings as i32))
        .collect();
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
    fn the_order_is_the_slope_of_the_errors_above_rounding() {
        let rounded = |errors: &[f64]| order_of(errors).map(|order| (order * 1e6).round() / 1e6);
        assert_eq!(rounded(&[0.4, 0.1]), Some(2.0));
        assert_eq!(rounded(&[0.4, 0.2, 0.1, 0.05]), Some(1.0));
        // One that wavers counts less among four: the slopes between neighbours are 1, 3, 2.
        assert_eq!(rounded(&[0.64, 0.32, 0.04, 0.01]), Some(2.1));
        assert_eq!(rounded(&[0.4, 0.1, 1e-7, 0.1]), Some(2.0));
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
