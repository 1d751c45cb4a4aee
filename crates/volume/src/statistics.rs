//! What the voxels are like: range, mean, deviation, histogram, percentiles, and what is not finite.
//!
//! Types of 8 and 16 bits are counted value by value, and everything follows exactly from the counts. Wider
//! types take three passes: range and non-finite voxels; mean and a fine histogram over that range; deviation
//! about that mean. Chunks run in parallel and are added up in order, so that the result is the same each time.

use rayon::prelude::*;

use crate::for_voxels;
use crate::{Element, Voxels};

/// Bins of the histogram that comes with the statistics.
const BINS: usize = 256;
/// Bins from which percentiles of wide types are taken.
const FINE_BINS: usize = 1 << 16;
/// Voxels per parallel piece of work; fixed, because the order of float sums depends on it.
const CHUNK: usize = 1 << 20;

/// How many voxels fall in each of equally wide bins over `lo..=hi`.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Lower edge of the first bin.
    pub lo: f64,
    /// Upper edge of the last bin, which it includes.
    pub hi: f64,
    /// Finite voxels per bin; those outside `lo..=hi` are not counted.
    pub counts: Vec<u64>,
}

impl Histogram {
    pub(crate) fn empty(bins: usize) -> Self {
        Self {
            lo: 0.0,
            hi: 0.0,
            counts: vec![0; bins.max(1)],
        }
    }

    /// The histogram of the voxels that lie in `lo..=hi`, with at least 1 bin. Where `lo == hi`, all of those
    /// are in the first bin.
    #[must_use]
    pub fn of(voxels: &Voxels, lo: f64, hi: f64, bins: usize) -> Self {
        let bins = bins.max(1);
        Self {
            lo,
            hi,
            counts: for_voxels!(voxels, values => count_bins(values, lo, hi, bins)),
        }
    }

    /// Index of the bin of `value`, which must lie in `lo..=hi`.
    fn bin(lo: f64, hi: f64, bins: usize, value: f64) -> usize {
        // Halves, because the width of a range of float64 can pass the largest float64.
        let width = hi / 2.0 - lo / 2.0;
        if width <= 0.0 {
            return 0;
        }
        let at = (value / 2.0 - lo / 2.0) / width * bins as f64;
        (at as usize).min(bins - 1)
    }
}

fn add_counts(mut sum: Vec<u64>, part: &[u64]) -> Vec<u64> {
    sum.iter_mut().zip(part).for_each(|(a, b)| *a += b);
    sum
}

fn count_bins<T: Element>(values: &[T], lo: f64, hi: f64, bins: usize) -> Vec<u64> {
    values
        .par_chunks(CHUNK)
        .fold(
            || vec![0; bins],
            |mut counts, chunk| {
                for value in chunk.iter().map(|value| value.to_f64()) {
                    if lo <= value && value <= hi {
                        counts[Histogram::bin(lo, hi, bins, value)] += 1;
                    }
                }
                counts
            },
        )
        .reduce(|| vec![0; bins], |sum, part| add_counts(sum, &part))
}

/// Statistics over all voxels of a volume. Where no voxel is finite, `min`, `max`, `mean` and
/// `standard_deviation` are not-a-number.
#[derive(Clone, Debug)]
pub struct Statistics {
    /// Smallest finite value.
    pub min: f64,
    /// Largest finite value.
    pub max: f64,
    /// Mean of the finite values.
    pub mean: f64,
    /// Standard deviation of the finite values (of the population: divided by their number).
    pub standard_deviation: f64,
    /// Voxels with a finite value.
    pub finite_count: u64,
    /// Voxels that are not a number.
    pub nan_count: u64,
    /// Voxels that are plus infinity.
    pub positive_infinity_count: u64,
    /// Voxels that are minus infinity.
    pub negative_infinity_count: u64,
    /// 256 bins over the finite range.
    pub histogram: Histogram,
    ranks: Ranks,
}

/// What percentiles are taken from.
#[derive(Clone, Debug)]
enum Ranks {
    /// How often each value occurs, ascending.
    Exact(Vec<(f64, u64)>),
    /// A fine histogram over the finite range.
    Fine(Vec<u64>),
}

impl Statistics {
    pub(crate) fn of(voxels: &Voxels) -> Self {
        match voxels {
            Voxels::U8(values) => Self::of_counts(values, usize::from, |i| i as f64),
            Voxels::I8(values) => Self::of_counts(
                values,
                |v| (i16::from(v) + 128) as usize,
                |i| i as f64 - 128.0,
            ),
            Voxels::U16(values) => Self::of_counts(values, usize::from, |i| i as f64),
            Voxels::I16(values) => Self::of_counts(
                values,
                |v| (i32::from(v) + 32768) as usize,
                |i| i as f64 - 32768.0,
            ),
            _ => for_voxels!(voxels, values => Self::of_wide(values)),
        }
    }

    /// Smallest and largest finite value; `None` where there is none.
    #[must_use]
    pub fn range(&self) -> Option<(f64, f64)> {
        (self.finite_count > 0).then_some((self.min, self.max))
    }

    /// Whether any voxel is infinite or not a number.
    #[must_use]
    pub fn has_non_finite(&self) -> bool {
        self.nan_count + self.positive_infinity_count + self.negative_infinity_count > 0
    }

    /// The smallest value that at least `p` percent (0 to 100, clamped) of the finite voxels do not exceed.
    /// Exact for types of 8 and 16 bits; for wider ones within [`Statistics::percentile_error`]. Not-a-number
    /// where no voxel is finite or `p` is not a number.
    #[must_use]
    pub fn percentile(&self, p: f64) -> f64 {
        if self.finite_count == 0 || p.is_nan() {
            return f64::NAN;
        }
        let rank = (p.clamp(0.0, 100.0) / 100.0 * self.finite_count as f64).ceil() as u64;
        let rank = rank.clamp(1, self.finite_count);
        match &self.ranks {
            Ranks::Exact(counts) => {
                let mut below = 0;
                for &(value, count) in counts {
                    below += count;
                    if below >= rank {
                        return value;
                    }
                }
                self.max
            }
            // The ends are known exactly.
            Ranks::Fine(_) if rank == 1 => self.min,
            Ranks::Fine(_) if rank == self.finite_count => self.max,
            Ranks::Fine(counts) => {
                let mut below = 0;
                for (bin, &count) in counts.iter().enumerate() {
                    if below + count >= rank {
                        let inside = (rank - below) as f64 / count as f64;
                        let t = (bin as f64 + inside) / FINE_BINS as f64;
                        return self.min * (1.0 - t) + self.max * t;
                    }
                    below += count;
                }
                self.max
            }
        }
    }

    /// How far [`Statistics::percentile`] can be from the exact one: 0 for types of 8 and 16 bits, else
    /// `(max - min) / 65536`.
    #[must_use]
    pub fn percentile_error(&self) -> f64 {
        match self.ranks {
            Ranks::Exact(_) => 0.0,
            Ranks::Fine(_) => self.max / FINE_BINS as f64 - self.min / FINE_BINS as f64,
        }
    }

    fn of_counts<T: Element>(
        values: &[T],
        place: impl Fn(T) -> usize + Sync,
        value: impl Fn(usize) -> f64,
    ) -> Self {
        let size = 1 << (8 * size_of::<T>());
        let counts = values
            .par_chunks(CHUNK)
            .fold(
                || vec![0_u64; size],
                |mut counts, chunk| {
                    chunk.iter().for_each(|&v| counts[place(v)] += 1);
                    counts
                },
            )
            .reduce(|| vec![0; size], |sum, part| add_counts(sum, &part));
        let present: Vec<(f64, u64)> = counts
            .into_iter()
            .enumerate()
            .filter(|&(_, count)| count > 0)
            .map(|(i, count)| (value(i), count))
            .collect();
        let total = values.len() as f64;
        let mean = present.iter().map(|&(v, n)| v * n as f64).sum::<f64>() / total;
        let variance = present
            .iter()
            .map(|&(v, n)| (v - mean).powi(2) * n as f64)
            .sum::<f64>()
            / total;
        let (Some(&(min, _)), Some(&(max, _))) = (present.first(), present.last()) else {
            return Self::without_finite(Limits::default());
        };
        let mut histogram = Histogram {
            lo: min,
            hi: max,
            ..Histogram::empty(BINS)
        };
        for &(value, count) in &present {
            histogram.counts[Histogram::bin(min, max, BINS, value)] += count;
        }
        Self {
            min,
            max,
            mean,
            standard_deviation: variance.sqrt(),
            finite_count: values.len() as u64,
            nan_count: 0,
            positive_infinity_count: 0,
            negative_infinity_count: 0,
            histogram,
            ranks: Ranks::Exact(present),
        }
    }

    fn of_wide<T: Element>(values: &[T]) -> Self {
        let limits = values
            .par_chunks(CHUNK)
            .map(|chunk| {
                chunk
                    .iter()
                    .fold(Limits::default(), |l, v| l.with(v.to_f64()))
            })
            .reduce(Limits::default, Limits::merge);
        if limits.finite == 0 {
            return Self::without_finite(limits);
        }
        let Limits { min, max, .. } = limits;
        // Sums run on values scaled by a power of two to below 1, which is exact and cannot overflow.
        let scale = min
            .abs()
            .max(max.abs())
            .log2()
            .floor()
            .clamp(-1000.0, 1000.0);
        let unit = if min == 0.0 && max == 0.0 {
            1.0
        } else {
            (-scale).exp2()
        };
        let sum_of = |f: &(dyn Fn(f64) -> f64 + Sync)| -> f64 {
            let parts: Vec<f64> = values
                .par_chunks(CHUNK)
                .map(|chunk| {
                    let finite = chunk.iter().map(|v| v.to_f64()).filter(|v| v.is_finite());
                    finite.map(|v| f(v * unit)).sum()
                })
                .collect();
            parts.iter().sum::<f64>() / limits.finite as f64
        };
        let mean = sum_of(&|v| v);
        let variance = sum_of(&|v| (v - mean).powi(2));
        let fine = count_bins(values, min, max, FINE_BINS);
        let histogram = Histogram {
            lo: min,
            hi: max,
            // 256 divides 65536, and so each bin is the sum of fine ones.
            counts: fine
                .chunks(FINE_BINS / BINS)
                .map(|bins| bins.iter().sum())
                .collect(),
        };
        Self {
            min,
            max,
            mean: (mean / unit).clamp(min, max),
            standard_deviation: variance.sqrt() / unit,
            histogram,
            ranks: Ranks::Fine(fine),
            ..Self::without_finite(limits)
        }
    }

    fn without_finite(limits: Limits) -> Self {
        Self {
            min: f64::NAN,
            max: f64::NAN,
            mean: f64::NAN,
            standard_deviation: f64::NAN,
            finite_count: limits.finite,
            nan_count: limits.nan,
            positive_infinity_count: limits.positive_infinity,
            negative_infinity_count: limits.negative_infinity,
            histogram: Histogram::empty(BINS),
            ranks: Ranks::Exact(Vec::new()),
        }
    }
}

#[derive(Clone, Copy)]
struct Limits {
    min: f64,
    max: f64,
    finite: u64,
    nan: u64,
    positive_infinity: u64,
    negative_infinity: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            finite: 0,
            nan: 0,
            positive_infinity: 0,
            negative_infinity: 0,
        }
    }
}

impl Limits {
    fn with(mut self, value: f64) -> Self {
        if value.is_finite() {
            self.min = self.min.min(value);
            self.max = self.max.max(value);
            self.finite += 1;
        } else if value.is_nan() {
            self.nan += 1;
        } else if value > 0.0 {
            self.positive_infinity += 1;
        } else {
            self.negative_infinity += 1;
        }
        self
    }

    fn merge(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            finite: self.finite + other.finite,
            nan: self.nan + other.nan,
            positive_infinity: self.positive_infinity + other.positive_infinity,
            negative_infinity: self.negative_infinity + other.negative_infinity,
        }
    }
}
