//! A box of a level out of the finer one: the mean of the cells under each coarse cell, or their most frequent label.

use volgraph_volume::Element;

use super::levels::{Taps, taps};

/// Voxels that are made of float64.
pub(super) trait Cell: Element {
    /// The nearest value, to even where there are two.
    fn nearest(value: f64) -> Self;
    /// As `to_f64`, here so that it can be part of the loops that call it for every voxel.
    fn real(self) -> f64;
}

macro_rules! cells {
    ($($int:ident)* ; $($float:ident)*) => {
        $(impl Cell for $int {
            #[inline]
            fn real(self) -> f64 {
                self as f64
            }

            #[inline]
            fn nearest(value: f64) -> Self {
                // Saturates.
                value.round_ties_even() as Self
            }
        })*
        $(impl Cell for $float {
            #[inline]
            fn real(self) -> f64 {
                self as f64
            }

            #[inline]
            fn nearest(value: f64) -> Self {
                value as Self
            }
        })*
    };
}

cells! { u8 i8 u16 i16 u32 i32 u64 i64 ; f32 f64 }

/// What becomes of the cells under a coarse one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reduce {
    /// The mean of the finite ones by the parts they have of it; integers are rounded to the nearest, to even where there are two.
    Mean,
    /// The label with the largest part of it; the least of several.
    Mode,
}

/// A box of a coarse level, and what it is made of.
pub(super) struct Halving {
    taps: [Vec<Taps>; 3],
    /// First index and samples of the fine box.
    pub origin: [u32; 3],
    pub size: [u32; 3],
}

impl Halving {
    /// For a box of a level of dimensions `coarse` out of the level of `fine`.
    pub fn new(fine: [u32; 3], coarse: [u32; 3], origin: [u32; 3], size: [u32; 3]) -> Self {
        let taps = [0, 1, 2].map(|axis| -> Vec<Taps> {
            let range = origin[axis]..origin[axis] + size[axis];
            range.map(|i| taps(i, fine[axis], coarse[axis])).collect()
        });
        let ends = [0, 1, 2].map(|axis| {
            let (first, last) = (taps[axis].first(), taps[axis].last());
            let last = last.map_or(0, |last| last.first + last.count);
            (first.map_or(0, |first| first.first), last)
        });
        Self {
            taps,
            origin: ends.map(|(first, _)| first),
            size: ends.map(|(first, end)| end - first),
        }
    }

    /// The coarse box out of the values of the fine one.
    pub fn apply<T: Cell>(&self, fine: &[T], reduce: Reduce) -> Vec<T> {
        let [tx, ty, tz] = &self.taps;
        let mut out = Vec::with_capacity(tx.len() * ty.len() * tz.len());
        let width = self.size[0] as usize;
        let even = tx.iter().all(|taps| taps.weights == [0.5, 0.5, 0.0]);
        let mut sums = vec![0.0; tx.len()];
        let mut rows: Vec<(&[T], f64)> = Vec::with_capacity(9);
        for z in tz {
            for y in ty {
                rows.clear();
                for (k, wz) in self.along(z, 2) {
                    for (j, wy) in self.along(y, 1) {
                        let at = (k * self.size[1] as usize + j) * width;
                        rows.push((&fine[at..at + width], wy * wz));
                    }
                }
                if reduce == Reduce::Mode {
                    out.extend(tx.iter().map(|x| self.mode(&rows, x)));
                    continue;
                }
                let finite = |row: &[T]| row.iter().all(|value| value.real().is_finite());
                if T::TYPE.is_float() && !rows.iter().all(|(row, _)| finite(row)) {
                    out.extend(tx.iter().map(|x| self.finite_mean(&rows, x)));
                    continue;
                }
                sums.fill(0.0);
                for &(row, weight) in &rows {
                    if even {
                        let half = weight / 2.0;
                        for (sum, pair) in sums.iter_mut().zip(row.chunks_exact(2)) {
                            *sum += half * pair[0].real() + half * pair[1].real();
                        }
                    } else {
                        for (sum, x) in sums.iter_mut().zip(tx) {
                            for (i, wx) in self.along(x, 0) {
                                *sum += weight * wx * row[i].real();
                            }
                        }
                    }
                }
                out.extend(sums.iter().map(|&sum| T::nearest(sum)));
            }
        }
        out
    }

    /// Indices into the fine box along an axis, and their weights.
    fn along(&self, taps: &Taps, axis: usize) -> impl Iterator<Item = (usize, f64)> {
        let first = (taps.first - self.origin[axis]) as usize;
        (first..).zip(taps.weights).take(taps.count as usize)
    }

    /// The mean of those that are finite; where none is, of the others.
    fn finite_mean<T: Cell>(&self, rows: &[(&[T], f64)], x: &Taps) -> T {
        let (mut sum, mut weights, mut others) = (0.0, 0.0, 0.0);
        for &(row, weight) in rows {
            for (i, wx) in self.along(x, 0) {
                let (value, weight) = (row[i].real(), weight * wx);
                if value.is_finite() {
                    sum += value * weight;
                    weights += weight;
                } else {
                    others += value;
                }
            }
        }
        T::nearest(if weights > 0.0 { sum / weights } else { others })
    }

    fn mode<T: Cell>(&self, rows: &[(&[T], f64)], x: &Taps) -> T {
        let mut found: Vec<(T, f64)> = Vec::with_capacity(27);
        for &(row, weight) in rows {
            for (i, wx) in self.along(x, 0) {
                match found.iter_mut().find(|(value, _)| *value == row[i]) {
                    Some((_, sum)) => *sum += weight * wx,
                    None => found.push((row[i], weight * wx)),
                }
            }
        }
        let mut best = (T::zeroed(), -1.0);
        for (value, weight) in found {
            // Sums of parts differ in their last digits.
            let near = (weight - best.1).abs() < 1e-9;
            if if near {
                value < best.0
            } else {
                weight > best.1
            } {
                best = (value, weight);
            }
        }
        best.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_cells_become_their_mean_and_ties_go_to_even() {
        let halving = Halving::new([4, 2, 2], [2, 1, 1], [0; 3], [2, 1, 1]);
        assert_eq!((halving.origin, halving.size), ([0; 3], [4, 2, 2]));
        let values: [u8; 16] = [1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 3, 3, 0, 0, 3, 3];
        assert_eq!(halving.apply(&values, Reduce::Mean), [0, 2]);
        assert_eq!(halving.apply(&values, Reduce::Mode), [0, 0]);
    }

    #[test]
    fn what_is_not_finite_does_not_count() {
        let halving = Halving::new([2, 1, 1], [1, 1, 1], [0; 3], [1, 1, 1]);
        let one = |values: [f32; 2]| halving.apply(&values, Reduce::Mean)[0];
        assert_eq!(one([3.0, f32::NAN]), 3.0);
        assert_eq!(one([f32::INFINITY, 1.0]), 1.0);
        assert!(one([f32::NAN; 2]).is_nan());
        assert_eq!(one([f32::INFINITY; 2]), f32::INFINITY);
    }

    #[test]
    fn a_box_of_an_odd_level_is_cut_out_of_the_whole() {
        let fine: Vec<f64> = (0..7 * 5 * 3).map(|i| f64::from(i * i % 31)).collect();
        let whole = Halving::new([7, 5, 3], [4, 3, 2], [0; 3], [4, 3, 2]);
        let all = whole.apply(&fine, Reduce::Mean);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        assert!((mean(&all) - mean(&fine)).abs() < 1e-12);
        let part = Halving::new([7, 5, 3], [4, 3, 2], [1, 1, 1], [2, 2, 1]);
        assert_eq!((part.origin, part.size), ([1, 1, 1], [5, 4, 2]));
        let mut cut = Vec::new();
        for z in 1..3 {
            for y in 1..5 {
                let at = (z * 5 + y) * 7;
                cut.extend_from_slice(&fine[at + 1..at + 6]);
            }
        }
        let got = part.apply(&cut, Reduce::Mean);
        let want: Vec<f64> = [(1, 1), (2, 1), (1, 2), (2, 2)]
            .map(|(x, y)| all[(3 + y) * 4 + x])
            .to_vec();
        for (a, b) in got.iter().zip(want) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}
