//! What the transfer function does between two neighbouring entries, integrated once for all lengths of a segment.
//!
//! A cell is cut at the knots inside it. Over each [`Piece`] the colour is linear in the scalar and the extinction is
//! linear, or `-ln(1 - α)` of a linear opacity: its integral is known in closed form.

use super::piece::Piece;
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

/// The `n - 1` cells between `n` entries.
pub(super) struct Cells<P> {
    pieces: Vec<P>,
    /// The pieces of cell `i` are `starts[i]..starts[i + 1]`.
    starts: Vec<usize>,
}

impl Cells<Piece<3>> {
    /// Good for cells of up to `longest` reference lengths; with so much `more` extinction everywhere, next to nothing.
    pub(super) fn integrate(transfer: &TransferFunction, n: u32, longest: f64, more: f64) -> Self {
        let piece = |from, to, share| {
            let (low, high) = transfer.color.curve.over(from, to);
            let change: [f64; 3] = std::array::from_fn(|i| high[i] - low[i]);
            let color = |t: f64| (std::array::from_fn(|i| low[i] + t * change[i]), change);
            let profile = Profile::over(&transfer.absorption, from, to);
            Piece::new(profile, share, longest, color).with_extinction(more)
        };
        Self::of_pieces(transfer, n, &transfer.knots(), piece)
    }

    /// `∫ c τ` and `∫ τ` over cell `cell`, a cell being 1 wide: means are over the depth.
    pub(super) fn integral(&self, cell: usize) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for piece in self.pieces(cell) {
            let depth = piece.share * piece.extinction;
            for (sum, c) in sum.iter_mut().zip(piece.mean.into_iter().chain([1.0])) {
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

/// The extinction over a piece, at `t` in 0..1.
#[derive(Clone, Copy)]
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

    /// From `t0` to `t1` alone.
    pub(super) fn part(self, t0: f64, t1: f64) -> Self {
        let between = |a: f64, b: f64| (a + t0 * (b - a), a + t1 * (b - a));
        match self {
            Self::Opacity(a, b) => {
                let (a, b) = between(a, b);
                Self::Opacity(a, b)
            }
            Self::Linear(a, b) => {
                let (a, b) = between(a, b);
                Self::Linear(a, b)
            }
        }
    }

    /// Whether an end is near the logarithm's pole, where rules of points need help.
    pub(super) fn is_at_pole(self) -> bool {
        match self {
            Self::Opacity(a, b) => {
                let (u, v) = (1.0 - a, 1.0 - b);
                u.max(v) > 3.0 * u.min(v)
            }
            Self::Linear(..) => false,
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
}
