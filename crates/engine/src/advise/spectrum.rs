//! Band limits of transfer functions and of volumes.
//!
//! A line of samples is mirrored at its ends, so that it has no jump there, its mean is taken away, and nothing is windowed:
//! a window would hide what lies at the ends, such as a peak of a transfer function at the end of its domain. Its highest
//! relevant frequency is the lowest one up to which [`ENERGY_SHARE`] of the energy lies, of all lines together.

use std::sync::Arc;

use rayon::prelude::*;
use realfft::{RealFftPlanner, RealToComplex};
use volgraph_optics::TransferFunction;
use volgraph_volume::Volume;

/// The share of the energy that counts.
pub const ENERGY_SHARE: f64 = 0.999;

/// Samples of a transfer function over the data's range.
pub const TRANSFER_SAMPLES: usize = 1 << 14;

/// Most lines of a volume that are looked at along an axis.
const MAX_LINES: usize = 4096;

/// Most voxels at which gradients are looked at.
const MAX_GRADIENTS: usize = 1 << 20;

/// The energies of mirrored lines of one length by frequency, summed up.
struct Energies {
    fft: Arc<dyn RealToComplex<f64>>,
    of: Vec<f64>,
}

impl Energies {
    fn new(samples: usize) -> Self {
        let fft = RealFftPlanner::new().plan_fft_forward(2 * samples);
        Self {
            fft,
            of: vec![0.0; samples + 1],
        }
    }

    fn add(&mut self, line: &[f64]) {
        let mean = line.iter().sum::<f64>() / line.len() as f64;
        let mut input: Vec<f64> = line
            .iter()
            .chain(line.iter().rev())
            .map(|value| value - mean)
            .collect();
        let mut output = self.fft.make_output_vec();
        // Both have the lengths that the transform asks for.
        if self.fft.process(&mut input, &mut output).is_ok() {
            for (sum, value) in self.of.iter_mut().zip(&output) {
                *sum += value.norm_sqr();
            }
        }
    }

    fn merge(mut self, other: &Self) -> Self {
        for (sum, more) in self.of.iter_mut().zip(&other.of) {
            *sum += more;
        }
        self
    }

    /// Cycles per sample up to which the share of the energy lies; 0 where nothing changes.
    fn band_limit(&self) -> f64 {
        let total: f64 = self.of.iter().skip(1).sum();
        if total <= 0.0 {
            return 0.0;
        }
        let mut sum = 0.0;
        let last = self.of.len() - 1;
        let reached = self.of.iter().enumerate().skip(1).find(|(_, energy)| {
            sum += **energy;
            sum >= ENERGY_SHARE * total
        });
        0.5 * reached.map_or(last, |(at, _)| at) as f64 / last as f64
    }
}

/// The highest relevant frequency of a line of samples, in cycles per sample, 0 to 1/2.
#[must_use]
pub fn band_limit(line: &[f64]) -> f64 {
    let mut energies = Energies::new(line.len().max(1));
    energies.add(line);
    energies.band_limit()
}

/// The highest relevant frequencies of a transfer function over the data values `low..high`, in cycles per data unit: of
/// its extinction, and the higher of it and of its colours times extinction. `position` gives its own scalars.
#[must_use]
pub fn of_transfer(
    transfer: &TransferFunction,
    (low, high): (f64, f64),
    position: impl Fn(f64) -> f64,
) -> (f64, f64) {
    let per_unit = (TRANSFER_SAMPLES - 1) as f64 / (high - low);
    let (from, to) = transfer.range();
    let curve = |value: &dyn Fn(f64) -> f64| {
        let line: Vec<f64> = (0..TRANSFER_SAMPLES)
            .map(|at| value(position(low + at as f64 / per_unit).clamp(from, to)))
            .collect();
        band_limit(&line) * per_unit
    };
    let extinction = curve(&|s| transfer.extinction(s));
    let colors = [0, 1, 2].map(|i| curve(&|s| transfer.extinction(s) * transfer.color(s)[i]));
    (extinction, colors.into_iter().fold(extinction, f64::max))
}

/// What the lines of a volume along an axis have.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct AxisSpectrum {
    /// The highest relevant frequency, cycles per voxel, 0 to 1/2.
    pub cycles_per_voxel: f64,
    /// World length of a voxel along it.
    pub spacing: f64,
    /// Lines that were looked at.
    pub lines: usize,
    /// Lines that there are.
    pub lines_in_all: usize,
}

/// The spectra of a volume along its axes, of lines spread evenly where there are too many.
#[must_use]
pub fn of_volume(volume: &Volume) -> [AxisSpectrum; 3] {
    let dims = volume.grid().dims;
    let spacing = volume.grid().spacing();
    [0, 1, 2].map(|axis| {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let all = dims[a] as usize * dims[b] as usize;
        let used = all.min(MAX_LINES);
        let samples = dims[axis] as usize;
        let energies = (0..used)
            .into_par_iter()
            .fold(
                || Energies::new(samples),
                |mut energies, number| {
                    // Multiples of the golden section fall evenly, and on no pattern of the grid.
                    let share = (number as f64 * 0.618_033_988_749_894_9).fract();
                    let at = if used == all {
                        number
                    } else {
                        let stratum = number * all / used;
                        let width = (number + 1) * all / used - stratum;
                        stratum + (share * width as f64) as usize
                    };
                    let mut index = [0_u32; 3];
                    index[a] = u32::try_from(at % dims[a] as usize).unwrap_or(0);
                    index[b] = u32::try_from(at / dims[a] as usize).unwrap_or(0);
                    let line: Vec<f64> = (0..dims[axis])
                        .map(|n| {
                            index[axis] = n;
                            volume.drawn(volume.voxel(index))
                        })
                        .collect();
                    energies.add(&line);
                    energies
                },
            )
            .reduce(|| Energies::new(samples), |a, b| a.merge(&b));
        AxisSpectrum {
            cycles_per_voxel: energies.band_limit(),
            spacing: spacing[axis],
            lines: used,
            lines_in_all: all,
        }
    })
}

/// Lengths of a volume's gradients in the world, by differences to the next voxel along each axis, rising; of voxels spread
/// evenly where there are too many.
#[must_use]
pub fn gradients(volume: &Volume) -> Vec<f64> {
    let dims = volume.grid().dims;
    let spacing = volume.grid().spacing();
    let [nx, ny, _] = dims.map(|n| n as usize);
    let all = volume.voxels().len();
    let stride = all.div_ceil(MAX_GRADIENTS).max(1);
    // A stride that divides the rows would look at few columns.
    let stride = if stride > 1 && nx.is_multiple_of(stride) {
        stride + 1
    } else {
        stride
    };
    let mut lengths: Vec<f64> = (0..all.div_ceil(stride))
        .into_par_iter()
        .map(|number| {
            let at = number * stride;
            let index =
                [at % nx, at / nx % ny, at / nx / ny].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
            let here = volume.drawn(volume.voxel(index));
            let square: f64 = (0..3)
                .map(|axis| {
                    let mut next = index;
                    next[axis] = (next[axis] + 1).min(dims[axis] - 1);
                    ((volume.drawn(volume.voxel(next)) - here) / spacing[axis]).powi(2)
                })
                .sum();
            square.sqrt()
        })
        .collect();
    lengths.par_sort_unstable_by(f64::total_cmp);
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_wave_has_its_own_frequency_and_a_line_none() {
        // A cosine that is even about both ends mirrors into itself: all of its energy is at one frequency.
        for cycles in [3.0, 11.0] {
            let line: Vec<f64> = (0..256)
                .map(|n| (2.0 * PI * cycles * (f64::from(n) + 0.5) / 256.0).cos())
                .collect();
            let limit = band_limit(&line);
            assert!((limit - cycles / 256.0).abs() < 1e-12, "{limit}");
        }
        assert_eq!(band_limit(&[2.5; 64]), 0.0);
        // Noise has all of them; of a single sample that stands out 99.9 % lie below 0.4995.
        let mut peak = [0.0; 512];
        peak[200] = 1.0;
        assert!(
            (band_limit(&peak) - 0.4995).abs() < 2e-3,
            "{}",
            band_limit(&peak)
        );
    }

    #[test]
    fn a_narrow_peak_of_a_transfer_function_asks_for_more() {
        let limit = |width: f64| {
            let text = format!(
                "(domain: range, color: (1, 1, 1), extinction: [({:?}, 0.0), (0.5, 1.0), ({:?}, 0.0)])",
                0.5 - width,
                0.5 + width
            );
            let transfer = TransferFunction::parse("t.ron".as_ref(), &text).unwrap();
            of_transfer(&transfer, (10.0, 30.0), |value| (value - 10.0) / 20.0).0
        };
        // The spectrum of a triangle is a squared sinc of the frequency times half its width, 2 data units: narrower by ten,
        // wider by ten; 99.9 % of the integral of its square lie below 1.556. A mirrored line of 20
        // units tells frequencies of 1/40 apart.
        let (wide, narrow) = (limit(0.1), limit(0.01));
        assert!((narrow / wide - 10.0).abs() < 0.5, "{wide} {narrow}");
        assert!((wide * 2.0 - 1.556).abs() <= 2.0 / 40.0, "{wide}");
    }
}
