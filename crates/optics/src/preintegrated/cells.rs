//! What the transfer function does between two neighbouring entries, integrated once for all segment lengths.
//!
//! A cell is cut at the knots inside it. Over each piece the colour is linear in the scalar and the extinction
//! is linear, or `-ln(1 - α)` of a linear opacity: its integral is known in closed form. The colour is then
//! taken as linear in the share of the piece's optical depth passed, with the mean and the first moment that it
//! really has, and that can be integrated exactly against the attenuation for any length.

use super::{Composite, Stretch};
use crate::post::node;
use crate::transfer::Absorption;
use crate::{MAX_EXTINCTION_FROM_OPACITY, TransferFunction, opacity_from_extinction};

/// Nodes in 0..1 and weights of the Gauss-Legendre rule of eight points.
pub(super) const GAUSS: [(f64, f64); 8] = {
    const HALF: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
    ];
    let mut rule = [(0.0, 0.0); 8];
    let mut i = 0;
    while i < 4 {
        let (x, w) = HALF[i];
        rule[2 * i] = (0.5 - 0.5 * x, 0.5 * w);
        rule[2 * i + 1] = (0.5 + 0.5 * x, 0.5 * w);
        i += 1;
    }
    rule
};

/// `∫₀¹ f`.
fn gauss(f: impl Fn(f64) -> f64) -> f64 {
    GAUSS.iter().map(|&(x, w)| w * f(x)).sum()
}

/// A part of a cell without a knot inside.
pub(super) struct Piece {
    /// Its share of the cell's length.
    share: f64,
    /// Mean extinction per reference length.
    extinction: f64,
    /// Mean colour, weighted by extinction.
    color: [f64; 3],
    /// Change of colour over the piece's optical depth, towards higher scalars.
    slope: [f64; 3],
}

/// The `n - 1` cells between `n` entries.
pub(super) struct Cells<P> {
    pieces: Vec<P>,
    /// The pieces of cell `i` are `starts[i]..starts[i + 1]`.
    starts: Vec<usize>,
}

impl Cells<Piece> {
    pub(super) fn integrate(transfer: &TransferFunction, n: u32) -> Self {
        let piece = |from, to, share| Piece::integrate(transfer, from, to, share);
        Self::of_pieces(transfer, n, &transfer.knots(), piece)
    }

    /// `∫ c τ` and `∫ τ` over cell `cell`, a cell being 1 wide.
    pub(super) fn integral(&self, cell: usize) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for piece in self.pieces(cell) {
            let depth = piece.share * piece.extinction;
            for (sum, c) in sum.iter_mut().zip(piece.color.into_iter().chain([1.0])) {
                *sum += c * depth;
            }
        }
        sum
    }

    /// Cell `cell` where it is `length` reference lengths long.
    pub(super) fn stretch(&self, cell: usize, length: f64) -> Stretch<3> {
        self.pieces(cell)
            .iter()
            .fold(Stretch::EMPTY, |stretch, piece| {
                stretch.then(piece.stretch(length))
            })
    }
}

impl<P> Cells<P> {
    /// Cuts at `knots`, and makes each piece of its ends and its share of the cell.
    pub(super) fn of_pieces(
        transfer: &TransferFunction,
        n: u32,
        knots: &[f64],
        piece: impl Fn(f64, f64, f64) -> P,
    ) -> Self {
        let mut cells = Self {
            pieces: Vec::new(),
            starts: vec![0],
        };
        for i in 0..n - 1 {
            let (lo, hi) = (
                node(transfer.range(), n, i),
                node(transfer.range(), n, i + 1),
            );
            let first = knots.partition_point(|knot| *knot <= lo);
            let inside = knots[first..].iter().copied().take_while(|knot| *knot < hi);
            let mut from = lo;
            for to in inside.chain([hi]) {
                cells.pieces.push(piece(from, to, (to - from) / (hi - lo)));
                from = to;
            }
            cells.starts.push(cells.pieces.len());
        }
        cells
    }

    /// The pieces of cell `cell`, towards higher scalars.
    pub(super) fn pieces(&self, cell: usize) -> &[P] {
        &self.pieces[self.starts[cell]..self.starts[cell + 1]]
    }
}

impl Piece {
    fn integrate(transfer: &TransferFunction, from: f64, to: f64, share: f64) -> Self {
        let profile = Profile::over(&transfer.absorption, from, to);
        let (at_from, at_to) = transfer.color.curve.over(from, to);
        let extinction = profile.integral(1.0);
        // With x(t) the share of optical depth passed at t, and c(t) linear: the mean of c over x is
        // c₀ + Δc (1 - ∫x dt), and its first moment ∫c (x - ½) dx = Δc ∫ x (1 - x) dt / 2, by parts.
        let passed = |t: f64| {
            if extinction > 0.0 {
                profile.integral(t) / extinction
            } else {
                t
            }
        };
        let mean = 1.0 - gauss(passed);
        let slope = 6.0 * gauss(|t| passed(t) * (1.0 - passed(t)));
        let change: [f64; 3] = std::array::from_fn(|i| at_to[i] - at_from[i]);
        Self {
            share,
            extinction,
            color: std::array::from_fn(|i| at_from[i] + mean * change[i]),
            slope: change.map(|c| slope * c),
        }
    }

    fn stretch(&self, length: f64) -> Stretch<3> {
        let depth = self.extinction * self.share * length;
        let transmittance = (-depth).exp();
        let opacity = opacity_from_extinction(depth);
        let skew = skew(depth, opacity, transmittance);
        Stretch {
            rising: std::array::from_fn(|i| self.color[i] * opacity + self.slope[i] * skew),
            falling: std::array::from_fn(|i| self.color[i] * opacity - self.slope[i] * skew),
            depth,
            transmittance,
        }
    }
}

/// `∫₀¹ (x - ½) T exp(-T x) dx`, at most 0: how much more the near half of a piece of depth `T` is seen.
pub(super) fn skew(depth: f64, opacity: f64, transmittance: f64) -> f64 {
    if depth < 1e-2 {
        // The closed form cancels here; the next term of the series is below 1e-15.
        let t = depth;
        t * t * (-1.0 / 12.0 + t * (1.0 / 24.0 + t * (-1.0 / 80.0 + t / 360.0)))
    } else {
        opacity / depth - transmittance - 0.5 * opacity
    }
}

/// The extinction over a piece, at `t` in 0..1.
pub(super) enum Profile {
    /// `-ln(1 - α)` of an opacity that goes linearly from the first to the second, both below the cap.
    Opacity(f64, f64),
    /// Linear from the first to the second.
    Linear(f64, f64),
}

impl Profile {
    pub(super) fn over(absorption: &Absorption, from: f64, to: f64) -> Self {
        let ([a], [b]) = absorption.curve().over(from, to);
        match absorption {
            Absorption::Extinction(_) => Self::Linear(a, b),
            Absorption::Opacity(_) => {
                // Where the opacity meets the cap is a knot, so a piece lies below it or beyond it.
                let cap = opacity_from_extinction(MAX_EXTINCTION_FROM_OPACITY);
                if 0.5 * (a + b) >= cap {
                    Self::Linear(MAX_EXTINCTION_FROM_OPACITY, MAX_EXTINCTION_FROM_OPACITY)
                } else {
                    Self::Opacity(a.min(cap), b.min(cap))
                }
            }
        }
    }

    /// `∫₀ᵗ τ`.
    pub(super) fn integral(&self, t: f64) -> f64 {
        match *self {
            Self::Linear(a, b) => t * (a + 0.5 * t * (b - a)),
            Self::Opacity(a, b) => t * mean_extinction(a, a + t * (b - a)),
        }
    }
}

/// Mean of `-ln(1 - α)` while `α` goes from `a` to `b`, both below 1.
fn mean_extinction(a: f64, b: f64) -> f64 {
    let (u, v) = (1.0 - a, 1.0 - b);
    if (v - u).abs() > 0.5 * u.max(v) {
        // The antiderivative u - u ln u; near u = v it would cancel, and far from it the logarithm's pole at
        // u = 0 would spoil a rule of points.
        1.0 - (v * v.ln() - u * u.ln()) / (v - u)
    } else {
        gauss(|t| -(-(a + t * (b - a))).ln_1p())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_extinction_agrees_with_fine_sums_and_with_itself() {
        for (a, b) in [
            (0.0, 0.3),
            (0.0, 0.51),
            (0.2, 0.999),
            (0.9, 0.1),
            (1e-9, 2e-9),
            (0.4, 0.4),
        ] {
            let n = 200_000;
            let at = |i: i32| a + (f64::from(i) + 0.5) / f64::from(n) * (b - a);
            let sum: f64 = (0..n).map(|i| -(-at(i)).ln_1p()).sum::<f64>() / f64::from(n);
            assert!(
                (mean_extinction(a, b) - sum).abs() < 1e-8 * sum.max(1e-6),
                "{a} to {b}"
            );
        }
        // ∫₀¹ -ln(1 - α) dα = 1, but for the last bit below the cap.
        assert!((mean_extinction(0.0, 1.0 - 1e-12) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn the_skew_is_continuous_where_its_form_changes_and_agrees_with_sums() {
        for depth in [1e-4, 9.999e-3, 1.0001e-2, 0.5, 3.0, 40.0] {
            let n = 100_000;
            let x = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
            let sum = (0..n)
                .map(|i| (x(i) - 0.5) * depth * (-depth * x(i)).exp())
                .sum::<f64>()
                / f64::from(n);
            let value = skew(depth, opacity_from_extinction(depth), (-depth).exp());
            assert!(
                (value - sum).abs() < 1e-7 * depth * depth.min(1.0),
                "{depth}: {value} and {sum}"
            );
        }
    }
}
