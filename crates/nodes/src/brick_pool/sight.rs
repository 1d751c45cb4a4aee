//! What a picture shows of scalars: how much colour and extinction change with them, and how wrong a pixel is where they are.

use volgraph_optics::{Domain, TransferFunction};

use crate::encoding::Scalars;
use crate::placement;

/// Samples of the transfer function over the range of the data.
const SAMPLES: usize = 2048;

/// Colour times extinction (three), and extinction, per world unit.
type Light = [f64; 4];

/// What is seen of scalars.
#[derive(Debug)]
pub(super) struct Sight {
    low: f64,
    /// Scalars from one sample to the next.
    step: f64,
    /// Least and most of each channel over 2^k samples from each on.
    least: Vec<Vec<Light>>,
    most: Vec<Vec<Light>>,
    /// The largest change of any channel from a sample to the next, over 2^k of them.
    steepest: Vec<Vec<f64>>,
}

impl Sight {
    /// Of a transfer function, for a volume with this smallest spacing.
    pub fn new(transfer: &TransferFunction, scalars: Scalars, voxel: f64) -> Self {
        let (low, high) = placement::data_range(scalars);
        let (from, to) = match transfer.domain() {
            Domain::Data => (0.0, 1.0),
            Domain::Normalised => placement::normalised_range(scalars),
            Domain::Range => (low, high),
        };
        let per_world = transfer.reference_length().extinction_per_world(voxel);
        let step = (high - low) / (SAMPLES - 1) as f64;
        let lights: Vec<Light> = (0..SAMPLES)
            .map(|at| {
                let scalar = (low + at as f64 * step - from) / (to - from);
                let extinction = transfer.extinction(scalar) * per_world;
                let [r, g, b] = transfer.color(scalar).map(|color| color * extinction);
                [r, g, b, extinction]
            })
            .collect();
        let steep: Vec<f64> = lights
            .windows(2)
            .map(|pair| (0..4).map(|i| (pair[1][i] - pair[0][i]).abs()).fold(0.0, f64::max))
            .collect();
        Self {
            low,
            step,
            least: over_powers(lights.clone(), |a, b| std::array::from_fn(|i| f64::min(a[i], b[i]))),
            most: over_powers(lights, |a, b| std::array::from_fn(|i| f64::max(a[i], b[i]))),
            steepest: over_powers(steep, |a, b| f64::max(*a, *b)),
        }
    }

    /// An estimate of how wrong pixels are behind a brick so thick (world units), with scalars in a range, which are wrong by
    /// so much in the root mean square: in units of colour, of which 1 is white.
    pub fn error(&self, (min, max): (f64, f64), rms: f64, thickness: f64, voxels: f64) -> f64 {
        let at = |scalar: f64| {
            let place = (scalar - self.low) / self.step;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped to the samples"
            )]
            let at = place.clamp(0.0, (SAMPLES - 1) as f64) as usize;
            at
        };
        let (first, last) = (at(min), (at(max) + 1).min(SAMPLES - 1));
        let pick = |of: &[Vec<Light>], fold: fn(f64, f64) -> f64| -> Light {
            let (row, back) = span(first, last + 1);
            let (a, b) = (of[row][first], of[row][back]);
            std::array::from_fn(|i| fold(a[i], b[i]))
        };
        let (least, most) = (pick(&self.least, f64::min), pick(&self.most, f64::max));
        let spread = (0..4).map(|i| most[i] - least[i]).fold(0.0, f64::max);
        let steepest = if last > first {
            let (row, back) = span(first, last);
            self.steepest[row][first].max(self.steepest[row][back]) / self.step
        } else {
            0.0
        };
        let wrong = (steepest * rms).min(spread);
        // What lies deep within a brick that absorbs is seen the less.
        let depth = least[3] * thickness;
        let seen = if depth > 1e-3 {
            thickness * (1.0 - (-depth).exp()) / depth
        } else {
            thickness
        };
        // Errors of one voxel and the next are taken as independent.
        (wrong * seen / voxels.max(1.0).sqrt()).min(1.0)
    }
}

/// The row of powers of two, and the second place, whose two entries cover `first..end`.
fn span(first: usize, end: usize) -> (usize, usize) {
    let row = (end - first).max(1).ilog2() as usize;
    (row, end - (1 << row))
}

/// Entry `i` of row `k` is that of `2^k` values from `i` on.
fn over_powers<T: Clone>(values: Vec<T>, join: impl Fn(&T, &T) -> T) -> Vec<Vec<T>> {
    let mut rows = vec![values];
    loop {
        let (last, half) = (&rows[rows.len() - 1], 1 << (rows.len() - 1));
        if last.len() <= half {
            return rows;
        }
        let next = (0..last.len() - half).map(|i| join(&last[i], &last[i + half]));
        let next = next.collect();
        rows.push(next);
    }
}
