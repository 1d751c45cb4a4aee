//! Frame times and their ratios, as plain numbers.
//!
//! Times vary with what else the machine does, so a time is never one number: a [`Summary`] has the smallest,
//! the median and the largest of some samples. Two programs are compared by running them in turn and taking
//! the [`ratio`] of each pair of neighbours, in which slow drifts of the machine cancel.

use serde::Serialize;

use crate::MeasureError;

/// Smallest, median and largest of some samples, in the samples' unit (milliseconds for times, none for ratios).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The smallest.
    pub min: f64,
    /// The middle one, or the mean of the middle two.
    pub median: f64,
    /// The largest.
    pub max: f64,
    /// How many there are.
    pub n: usize,
}

impl Summary {
    /// Summarises the samples.
    ///
    /// # Errors
    /// [`MeasureError::NoSamples`], [`MeasureError::Sample`] for one that is not finite.
    pub fn of(samples: &[f64]) -> Result<Self, MeasureError> {
        if let Some(index) = samples.iter().position(|sample| !sample.is_finite()) {
            return Err(MeasureError::Sample {
                index,
                value: samples[index],
            });
        }
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        let (Some(&min), Some(&max)) = (sorted.first(), sorted.last()) else {
            return Err(MeasureError::NoSamples);
        };
        let median = 0.5 * sorted[(n - 1) / 2] + 0.5 * sorted[n / 2];
        Ok(Self {
            min,
            median,
            max,
            n,
        })
    }
}

/// Summarises `a[i] / b[i]`: how many times longer the first took, run in turn with the second.
///
/// # Errors
/// [`MeasureError::Unpaired`], and those of [`Summary::of`], also where a sample of `b` is 0.
pub fn ratio(a: &[f64], b: &[f64]) -> Result<Summary, MeasureError> {
    if a.len() != b.len() {
        return Err(MeasureError::Unpaired {
            a: a.len(),
            b: b.len(),
        });
    }
    let ratios: Vec<f64> = a.iter().zip(b).map(|(a, b)| a / b).collect();
    Summary::of(&ratios)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summaries_of_odd_and_even_numbers_of_samples() {
        let odd = Summary::of(&[3.0, 1.0, 10.0]).unwrap();
        assert_eq!(
            odd,
            Summary {
                min: 1.0,
                median: 3.0,
                max: 10.0,
                n: 3
            }
        );
        let even = Summary::of(&[4.0, 1.0, 10.0, 3.0]).unwrap();
        assert_eq!(
            even,
            Summary {
                min: 1.0,
                median: 3.5,
                max: 10.0,
                n: 4
            }
        );
        assert_eq!(Summary::of(&[2.0]).unwrap().median, 2.0);
        assert!(matches!(Summary::of(&[]), Err(MeasureError::NoSamples)));
        assert!(matches!(
            Summary::of(&[1.0, f64::NAN]),
            Err(MeasureError::Sample { index: 1, .. })
        ));
    }

    #[test]
    fn ratios_are_of_pairs() {
        // A machine that slows down threefold half way does not change the ratio.
        let summary = ratio(&[2.0, 2.0, 6.0, 6.0], &[1.0, 1.0, 3.0, 3.0]).unwrap();
        assert_eq!(
            summary,
            Summary {
                min: 2.0,
                median: 2.0,
                max: 2.0,
                n: 4
            }
        );
        assert!(matches!(
            ratio(&[1.0], &[]),
            Err(MeasureError::Unpaired { a: 1, b: 0 })
        ));
        assert!(matches!(
            ratio(&[1.0], &[0.0]),
            Err(MeasureError::Sample { index: 0, .. })
        ));
    }
}
