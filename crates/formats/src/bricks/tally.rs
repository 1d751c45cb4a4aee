//! Range, mean and what is not finite, added up over parts of a volume.

use std::ops::Range;

use volgraph_volume::{Voxels, for_voxels};

use super::halve::Cell;

/// Counts of some voxels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tally {
    pub min: f64,
    pub max: f64,
    pub sum: f64,
    pub finite: u64,
    pub nan: u64,
    pub positive: u64,
    pub negative: u64,
}

impl Default for Tally {
    fn default() -> Self {
        Self {
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            sum: 0.0,
            finite: 0,
            nan: 0,
            positive: 0,
            negative: 0,
        }
    }
}

impl Tally {
    /// Of the voxels of a box of `size` that are in the ranges of it.
    pub fn of(voxels: &Voxels, size: [u32; 3], part: &[Range<u32>; 3]) -> Self {
        for_voxels!(voxels, values => Self::of_values(values, size, part))
    }

    fn of_values<T: Cell>(values: &[T], size: [u32; 3], part: &[Range<u32>; 3]) -> Self {
        let [nx, ny, _] = size.map(|n| n as usize);
        let [xs, ys, zs] = part.clone().map(|r| r.start as usize..r.end as usize);
        let mut all = Self::default();
        for z in zs {
            for y in ys.clone() {
                let at = (z * ny + y) * nx;
                let row = &values[at + xs.start..at + xs.end];
                if T::TYPE.is_float() {
                    row.iter().for_each(|value| all.add(value.real()));
                } else {
                    all.add_whole(row);
                }
            }
        }
        all
    }

    fn add_whole<T: Cell>(&mut self, row: &[T]) {
        let Some(&first) = row.first() else { return };
        let (mut min, mut max, mut sum) = (first, first, 0.0);
        for &value in row {
            min = if value < min { value } else { min };
            max = if value > max { value } else { max };
            sum += value.real();
        }
        self.min = self.min.min(min.real());
        self.max = self.max.max(max.real());
        self.sum += sum;
        self.finite += row.len() as u64;
    }

    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.min = self.min.min(value);
            self.max = self.max.max(value);
            self.sum += value;
            self.finite += 1;
        } else if value.is_nan() {
            self.nan += 1;
        } else if value > 0.0 {
            self.positive += 1;
        } else {
            self.negative += 1;
        }
    }

    /// In a fixed order, for the sum is a float.
    pub fn merge(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.sum += other.sum;
        self.finite += other.finite;
        self.nan += other.nan;
        self.positive += other.positive;
        self.negative += other.negative;
    }

    /// The range of the finite values; zeros where there is none.
    pub fn range(&self) -> (f64, f64) {
        if self.finite == 0 {
            (0.0, 0.0)
        } else {
            (self.min, self.max)
        }
    }

    pub fn mean(&self) -> f64 {
        let (min, max) = self.range();
        let mean = self.sum / self.finite.max(1) as f64;
        // A sum past float64 has none.
        if mean.is_finite() {
            mean.clamp(min, max)
        } else {
            min / 2.0 + max / 2.0
        }
    }
}
