//! A part of a cell without a knot inside: what it emits towards both ends at any length.
//!
//! Each channel is taken as quadratic in the share of the piece's optical depth passed, with the mean and the two
//! moments that it really has; that can be integrated exactly against the attenuation for any length. What is left of
//! the channel is blind to attenuation up to its third power. Where that is not enough (the piece is deep, and its
//! extinction far from even), the piece is asked for its two halves instead, and they for theirs.

use super::cells::{GAUSS, Profile};
use super::{Composite, Stretch};

/// Largest error of a piece's colour, as a share of its opacity: so that of a whole segment is no larger.
const TOLERANCE: f64 = 1.5e-7;

/// Halves of halves; the last ones are 4096 times smaller.
const MAX_LEVELS: u32 = 12;

/// A piece with `N` channels.
pub(super) struct Piece<const N: usize> {
    /// Its share of the cell's length.
    pub(super) share: f64,
    /// Mean extinction per reference length.
    pub(super) extinction: f64,
    /// Of each channel, over the share `x` of the optical depth passed: `mean + slope (x - ½) + curve (x² - x + ⅙)`.
    pub(super) mean: [f64; N],
    pub(super) slope: [f64; N],
    pub(super) curve: [f64; N],
    /// The length of the cell, in reference lengths, up to which that is good enough.
    pub(super) longest: f64,
    pub(super) halves: Option<Box<[Self; 2]>>,
}

impl<const N: usize> Piece<N> {
    /// Good for cells of up to `longest` reference lengths; `channels` gives value and change at `t` in 0..1.
    pub(super) fn new(
        profile: Profile,
        share: f64,
        longest: f64,
        channels: impl Fn(f64) -> ([f64; N], [f64; N]),
    ) -> Self {
        let whole = Whole {
            profile,
            share,
            longest,
            channels,
        };
        whole.part(0.0, 1.0, 0)
    }

    /// With more extinction per reference length, evenly: so little that it hides nothing of the piece itself.
    pub(super) fn with_extinction(mut self, more: f64) -> Self {
        if let Some(halves) = self.halves {
            self.halves = Some(Box::new(halves.map(|half| half.with_extinction(more))));
        }
        self.extinction += more;
        self
    }

    /// Where its cell is `length` reference lengths long.
    pub(super) fn stretch(&self, length: f64) -> Stretch<N> {
        if let (true, Some(halves)) = (length > self.longest, &self.halves) {
            return halves[0].stretch(length).then(halves[1].stretch(length));
        }
        let depth = self.extinction * self.share * length;
        let Seen { opacity, skew, bow } = seen(depth);
        Stretch {
            rising: std::array::from_fn(|i| {
                self.mean[i] * opacity + self.slope[i] * skew + self.curve[i] * bow
            }),
            falling: std::array::from_fn(|i| {
                self.mean[i] * opacity - self.slope[i] * skew + self.curve[i] * bow
            }),
            depth,
            transmittance: 1.0 - opacity,
        }
    }
}

/// What a piece and its halves are made of.
struct Whole<F> {
    profile: Profile,
    share: f64,
    longest: f64,
    channels: F,
}

impl<F> Whole<F> {
    fn part<const N: usize>(&self, t0: f64, t1: f64, level: u32) -> Piece<N>
    where
        F: Fn(f64) -> ([f64; N], [f64; N]),
    {
        let width = t1 - t0;
        let profile = self.profile.part(t0, t1);
        let extinction = profile.integral(1.0);
        let channels = |t: f64| (self.channels)(t0 + t * width);
        let passed = |t: f64| {
            if extinction > 0.0 {
                profile.integral(t) / extinction
            } else {
                t
            }
        };
        // The moments of a channel e over x(t), each by parts, with e' = de/dt:
        // ∫ e dx = e(1) - ∫ e' x dt, ∫ e (x - ½) dx = ∫ e' x (1 - x) / 2 dt and
        // ∫ e (x² - x + ⅙) dx = -∫ e' x (1 - x) (1 - 2x) / 6 dt; the polynomials' squares are 1/12 and 1/180.
        let (mut mean, mut slope, mut curve) = (channels(1.0).0, [0.0; N], [0.0; N]);
        let is_at_pole = profile.is_at_pole();
        let mut met = [(0.0, [0.0; N]); GAUSS.len() + 2];
        for (at, (s, weight)) in met.iter_mut().zip(GAUSS) {
            // Towards the pole the points stand closer, and so it does no harm.
            let (t, weight) = if is_at_pole {
                (s * s * (3.0 - 2.0 * s), weight * 6.0 * s * (1.0 - s))
            } else {
                (s, weight)
            };
            let x = passed(t);
            let (value, change) = channels(t);
            *at = (x, value);
            for (i, change) in change.into_iter().enumerate() {
                let by = weight * width * change;
                mean[i] -= by * x;
                slope[i] += by * 6.0 * x * (1.0 - x);
                curve[i] -= by * 30.0 * x * (1.0 - x) * (1.0 - 2.0 * x);
            }
        }
        met[GAUSS.len()] = (0.0, channels(0.0).0);
        met[GAUSS.len() + 1] = (1.0, channels(1.0).0);
        let mut rest = 0.0_f64;
        for (x, value) in met {
            for (i, value) in value.into_iter().enumerate() {
                let taken = mean[i] + slope[i] * (x - 0.5) + curve[i] * (x * x - x + 1.0 / 6.0);
                rest = rest.max((value - taken).abs() / value.abs().max(1.0));
            }
        }
        let share = self.share * width;
        let longest = longest_depth(rest) / (extinction * share);
        let is_good = longest >= self.longest || level >= MAX_LEVELS || extinction <= 0.0;
        let halves = (!is_good).then(|| {
            let middle = t0 + 0.5 * width;
            Box::new([
                self.part(t0, middle, level + 1),
                self.part(middle, t1, level + 1),
            ])
        });
        Piece {
            share,
            extinction,
            mean,
            slope,
            curve,
            longest,
            halves,
        }
    }
}

/// The depth up to which a channel may differ by so much from the quadratic with its moments. Of the attenuation that
/// leaves what a quadratic in `x` cannot say: less than a share of `T³ / 200` of the opacity (`exp(-T x)` in Chebyshev
/// polynomials), and never more than all.
fn longest_depth(rest: f64) -> f64 {
    if rest <= TOLERANCE {
        f64::INFINITY
    } else {
        (200.0 * TOLERANCE / rest).cbrt()
    }
}

/// What is seen of a piece's colour through its own depth `T`: integrals against `T exp(-T x)` over `x` from 0 to 1.
pub(super) struct Seen {
    /// Of 1: its opacity.
    pub(super) opacity: f64,
    /// Of `x - ½`, at most 0: how much more the near half is seen.
    pub(super) skew: f64,
    /// Of `x² - x + ⅙`: how much more the ends are seen than the middle.
    pub(super) bow: f64,
}

pub(super) fn seen(depth: f64) -> Seen {
    let t = depth;
    if t < 5e-2 {
        // The closed forms cancel here; the next terms of the series are below 1e-16 of the value.
        let bow = 1.0 / 2520.0 + t * (-1.0 / 12096.0 + t / 72576.0);
        let skew = -1.0 / 80.0 + t * (1.0 / 360.0 + t * (-1.0 / 2016.0 + t / 13440.0));
        let opacity = 1.0 / 120.0 + t * (-1.0 / 720.0 + t * (1.0 / 5040.0 - t / 40320.0));
        Seen {
            opacity: t * (1.0 + t * (-0.5 + t * (1.0 / 6.0 + t * (-1.0 / 24.0 + t * opacity)))),
            skew: t * t * (-1.0 / 12.0 + t * (1.0 / 24.0 + t * skew)),
            bow: t * t * t * (1.0 / 360.0 + t * (-1.0 / 720.0 + t * bow)),
        }
    } else {
        let opacity = -(-t).exp_m1();
        let transmittance = 1.0 - opacity;
        let first = opacity / t - transmittance;
        let second = 2.0 * first / t - transmittance;
        Seen {
            opacity,
            skew: first - 0.5 * opacity,
            bow: second - first + opacity / 6.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_seen_agrees_with_sums_on_both_sides_of_where_the_form_changes() {
        for depth in [1e-4, 4.999e-2, 5.001e-2, 0.5, 3.0, 40.0] {
            let n = 100_000;
            let x = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
            let sum = |f: fn(f64) -> f64| {
                let terms = (0..n).map(|i| f(x(i)) * depth * (-depth * x(i)).exp());
                terms.sum::<f64>() / f64::from(n)
            };
            let seen = seen(depth);
            for (value, sum) in [
                (seen.opacity, sum(|_| 1.0)),
                (seen.skew, sum(|x| x - 0.5)),
                (seen.bow, sum(|x| x * x - x + 1.0 / 6.0)),
            ] {
                let error = (value - sum).abs();
                assert!(
                    error < 1e-7 * depth * depth.min(1.0),
                    "{depth}: {value} and {sum}"
                );
            }
        }
    }
}
