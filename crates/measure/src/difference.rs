//! Numbers for the difference of two pictures.
//!
//! All pixels are looked at once for values that are no numbers; then each pixel gives four signed errors, from
//! which the sums, the worst component and the sorted per-pixel errors come. Sums are float64.

use std::collections::BTreeMap;

use serde::Serialize;
use volgraph_picture::{LayerValues, Picture};

use crate::MeasureError;
use crate::flip::flip_mean;

/// A component of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Linear red, premultiplied.
    Red,
    /// Linear green, premultiplied.
    Green,
    /// Linear blue, premultiplied.
    Blue,
    /// Alpha.
    Alpha,
}

const CHANNELS: [Channel; 4] = [Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha];

/// The largest absolute error of any component; the first one, where several are as large.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WorstPixel {
    /// The error, 0 or more.
    pub error: f64,
    /// Column.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Component.
    pub channel: Channel,
}

/// The largest absolute error of a scalar buffer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WorstValue {
    /// The error, 0 or more.
    pub error: f64,
    /// Column.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
}

/// How the first picture differs from the second, on linear premultiplied RGBA.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Root of the mean squared error over all four components of all pixels.
    pub rmse: f64,
    /// The worst component.
    pub max: WorstPixel,
    /// 99.9th percentile (nearest rank) of the pixels' errors; a pixel's is its worst component's absolute one.
    pub p999: f64,
    /// Peak signal to noise ratio in decibels for a peak of 1: `-20 log₁₀ rmse`; infinite (in JSON null) where
    /// the pictures are equal.
    pub psnr_db: f64,
    /// Mean of first minus second for red, green, blue, alpha.
    pub mean_error: [f64; 4],
    /// Mean ꟻLIP of both over black, see [`flip_mean`]; `None` where it was not asked for or the picture has
    /// more than [`MAX_FLIP_PIXELS`](crate::MAX_FLIP_PIXELS).
    pub flip: Option<f64>,
    /// The depths, where both pictures have them.
    pub depth: Option<ScalarDifference>,
    /// The opacities, where both pictures have them.
    pub opacity: Option<ScalarDifference>,
    /// The layers that both pictures have, by name; of vectors all components together.
    pub layers: BTreeMap<String, ScalarDifference>,
}

/// How a scalar buffer of the first picture differs from that of the second.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScalarDifference {
    /// Pixels that are finite in both; the figures below are of these, and 0 where there are none.
    pub compared: u64,
    /// Pixels where one is infinite and the other is not so: in a depth buffer, hit by one picture only.
    pub one_sided: u64,
    /// Root of the mean squared error.
    pub rmse: f64,
    /// The worst pixel, if any was compared.
    pub max: Option<WorstValue>,
    /// 99.9th percentile (nearest rank) of the absolute errors.
    pub p999: f64,
    /// Mean of first minus second.
    pub mean_error: f64,
}

/// Compares two pictures of one size, with ꟻLIP.
///
/// # Errors
/// [`MeasureError::Sizes`], [`MeasureError::NotANumber`] for NaN anywhere and for infinite colour or opacity,
/// [`MeasureError::Picture`].
pub fn compare(a: &Picture, b: &Picture) -> Result<Comparison, MeasureError> {
    let mut comparison = compare_without_flip(a, b)?;
    comparison.flip = flip_mean(a, b)?;
    Ok(comparison)
}

/// As [`compare`], without the ꟻLIP, which takes most of the time.
///
/// # Errors
/// As [`compare`].
pub fn compare_without_flip(a: &Picture, b: &Picture) -> Result<Comparison, MeasureError> {
    check_pair(a, b)?;
    let width = a.width as usize;
    let mut squares = 0.0;
    let mut sums = [0.0; 4];
    let mut max = WorstPixel {
        error: 0.0,
        x: 0,
        y: 0,
        channel: Channel::Red,
    };
    let mut errors = Vec::with_capacity(a.color.len());
    for (i, (ours, theirs)) in a.color.iter().zip(&b.color).enumerate() {
        let mut worst = 0.0_f64;
        for (c, channel) in CHANNELS.into_iter().enumerate() {
            let error = f64::from(ours[c]) - f64::from(theirs[c]);
            squares += error * error;
            sums[c] += error;
            worst = worst.max(error.abs());
            if error.abs() > max.error {
                let (x, y) = place(i, (width, 1));
                max = WorstPixel {
                    error: error.abs(),
                    x,
                    y,
                    channel,
                };
            }
        }
        errors.push(worst);
    }
    let pixels = a.color.len() as f64;
    let rmse = (squares / (4.0 * pixels)).sqrt();
    Ok(Comparison {
        rmse,
        max,
        p999: percentile_999(&mut errors),
        psnr_db: -20.0 * rmse.log10(),
        mean_error: sums.map(|sum| sum / pixels),
        flip: None,
        depth: scalars(
            "depth",
            (width, 1),
            a.depth.as_deref(),
            b.depth.as_deref(),
            f32::is_nan,
        )?,
        opacity: scalars(
            "opacity",
            (width, 1),
            a.opacity.as_deref(),
            b.opacity.as_deref(),
            |v| !v.is_finite(),
        )?,
        layers: layers(a, b)?,
    })
}

/// The layers of one name and form that both have.
fn layers(a: &Picture, b: &Picture) -> Result<BTreeMap<String, ScalarDifference>, MeasureError> {
    let mut layers = BTreeMap::new();
    for layer in &a.layers {
        let width = a.width as usize;
        let difference = match (&layer.values, b.layer(&layer.name)) {
            (LayerValues::Scalar(ours), Some(LayerValues::Scalar(theirs))) => scalars(
                &layer.name,
                (width, 1),
                Some(ours),
                Some(theirs),
                f32::is_nan,
            )?,
            (LayerValues::Vector(ours), Some(LayerValues::Vector(theirs))) => scalars(
                &layer.name,
                (width, 4),
                Some(ours.as_flattened()),
                Some(theirs.as_flattened()),
                f32::is_nan,
            )?,
            _ => None,
        };
        if let Some(difference) = difference {
            layers.insert(layer.name.clone(), difference);
        }
    }
    Ok(layers)
}

/// One size, whole buffers, numbers in colour.
pub(crate) fn check_pair(a: &Picture, b: &Picture) -> Result<(), MeasureError> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(MeasureError::Sizes {
            a: (a.width, a.height),
            b: (b.width, b.height),
        });
    }
    a.check()?;
    b.check()?;
    let is_wrong = |color: &[f32; 4]| color.iter().any(|c| !c.is_finite());
    check_numbers(
        "colour",
        (a.width as usize, 1),
        &a.color,
        &b.color,
        is_wrong,
    )
}

/// Of a buffer whose rows have so many pixels, of so many values each.
fn check_numbers<T>(
    buffer: &str,
    row: (usize, usize),
    a: &[T],
    b: &[T],
    is_wrong: impl Fn(&T) -> bool,
) -> Result<(), MeasureError> {
    let (mut in_a, mut in_b, mut first) = (0, 0, None);
    for (i, (ours, theirs)) in a.iter().zip(b).enumerate() {
        let wrong = (is_wrong(ours), is_wrong(theirs));
        in_a += u64::from(wrong.0);
        in_b += u64::from(wrong.1);
        if wrong != (false, false) {
            first.get_or_insert(i);
        }
    }
    match first {
        None => Ok(()),
        Some(i) => {
            let (x, y) = place(i, row);
            Err(MeasureError::NotANumber {
                buffer: buffer.to_owned(),
                in_a,
                in_b,
                x,
                y,
            })
        }
    }
}

fn scalars(
    buffer: &str,
    row: (usize, usize),
    a: Option<&[f32]>,
    b: Option<&[f32]>,
    is_wrong: impl Fn(f32) -> bool,
) -> Result<Option<ScalarDifference>, MeasureError> {
    let (Some(a), Some(b)) = (a, b) else {
        return Ok(None);
    };
    check_numbers(buffer, row, a, b, |value| is_wrong(*value))?;
    let (mut squares, mut sum, mut one_sided) = (0.0, 0.0, 0);
    let mut max: Option<WorstValue> = None;
    let mut errors = Vec::with_capacity(a.len());
    for (i, (&ours, &theirs)) in a.iter().zip(b).enumerate() {
        if !(ours.is_finite() && theirs.is_finite()) {
            // Both infinitely far is agreement.
            one_sided += u64::from(ours != theirs);
            continue;
        }
        let error = f64::from(ours) - f64::from(theirs);
        squares += error * error;
        sum += error;
        errors.push(error.abs());
        if max.is_none_or(|max| error.abs() > max.error) {
            let (x, y) = place(i, row);
            max = Some(WorstValue {
                error: error.abs(),
                x,
                y,
            });
        }
    }
    let count = errors.len().max(1) as f64;
    Ok(Some(ScalarDifference {
        compared: errors.len() as u64,
        one_sided,
        rmse: f64::sqrt(squares / count),
        max,
        p999: percentile_999(&mut errors),
        mean_error: sum / count,
    }))
}

/// Column and row of value `i`, where a row is of so many pixels of so many values; a picture's sides fit u32.
fn place(i: usize, (pixels, values): (usize, usize)) -> (u32, u32) {
    let pixel = i / values;
    ((pixel % pixels) as u32, (pixel / pixels) as u32)
}

/// The smallest value that at least 99.9 % of all do not pass; 0 of none.
fn percentile_999(errors: &mut [f64]) -> f64 {
    // In whole numbers, for 0.999 · 1000 in floating point may round up to a rank too many.
    let rank = (errors.len() * 999).div_ceil(1000);
    if rank == 0 {
        return 0.0;
    }
    let (_, value, _) = errors.select_nth_unstable_by(rank - 1, f64::total_cmp);
    *value
}

#[cfg(test)]
mod tests {
    use super::percentile_999;

    #[test]
    fn the_percentile_is_of_the_nearest_rank() {
        let of =
            |n: usize| percentile_999(&mut (1..=n).rev().map(|v| v as f64).collect::<Vec<_>>());
        assert_eq!(
            [of(0), of(1), of(999), of(1000), of(1001), of(10_000)],
            [0.0, 1.0, 999.0, 999.0, 1000.0, 9990.0]
        );
    }
}
