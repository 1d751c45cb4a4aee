//! Pre-integrated tables for lit segments: material properties (Röttger et al. 2003, section 6) and the place in the
//! segment that its light comes from (Lum, Wilson, Ma 2004).
//!
//! A material's fraction times the colour is a product of two linear functions over a piece. For the moments each
//! channel `e` is taken a second time as `t · e`, with `t` the place in the piece from 0 to 1; composites then move
//! places by the lengths of what lies in front. So channels are polynomials over a piece ([`super::piece`]).

use super::cells::{Cells, Profile};
use super::piece::{Piece, seen};
use super::{Composite, Pair, Stretch, check, over, tabulate};
use crate::material::Material;
use crate::post::node;
use crate::{OpticsError, TransferFunction, opacity_from_extinction};

/// What segments of one length make of light, for each pair of scalars at their ends: `n × n` entries each, front
/// fastest, as in [`PreintegratedTable`](crate::PreintegratedTable). `c` is the colour, `τ` the extinction and `T` the
/// transmittance from the segment's front; `ka`, `kd`, `ks` and `m` are ambient, diffuse, specular and shininess.
///
/// Against float64 quadrature, with colours of 0 to 1 and segments of up to 6 reference lengths, the error of an entry
/// is below 1e-6 (of the last value: relative to the shininess).
#[derive(Clone, Debug, PartialEq)]
pub struct PreintegratedMaterial {
    /// Entries a side, `n`.
    pub size: u32,
    /// `∫ ka c τ T`, and in the fourth place `∫ ks τ T`.
    pub ambient: Vec<[f32; 4]>,
    /// `∫ kd c τ T`, and in the fourth place `∫ m ks τ T`: by `∫ ks τ T`, the mean shininess of the highlight.
    pub diffuse: Vec<[f32; 4]>,
}

/// Where in a segment its light comes from: integrals weighted by the place `t`, which runs from 0 at the segment's
/// front to 1 at its back. Light that changes linearly from `front` to `back` makes of a segment
/// `(whole - moment) · front + moment · back`, where `whole` is the same integral without `t`.
///
/// Against float64 quadrature, with colours of 0 to 1 and segments of up to 6 reference lengths, the error of an entry
/// is below 1e-6.
#[derive(Clone, Debug, PartialEq)]
pub struct PreintegratedMoments {
    /// Entries a side, `n`.
    pub size: u32,
    /// Of a material `∫ t kd c τ T`, and in the fourth place `∫ t ks τ T`; of none `∫ t c τ T` and `∫ t τ T`.
    pub entries: Vec<[f32; 4]>,
}

impl TransferFunction {
    /// The material, integrated over segments, as
    /// [`preintegrated_table`](TransferFunction::preintegrated_table) does colours; `default` where the transfer
    /// function does not say.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`], [`OpticsError::SegmentLength`].
    pub fn preintegrated_material(
        &self,
        n: u32,
        segment_length: f64,
        default: Material,
    ) -> Result<PreintegratedMaterial, OpticsError> {
        check(n, segment_length)?;
        let integrals = |weights: fn(Material) -> [f64; 2], last: fn(Material) -> f64| {
            let channels = Channels {
                transfer: self,
                default: Some(default),
                weights,
                last,
            };
            channels.integrals(n, segment_length)
        };
        Ok(PreintegratedMaterial {
            size: n,
            ambient: integrals(|m| [m.ambient, m.specular], |_| 1.0),
            diffuse: integrals(|m| [m.diffuse, m.specular], |m| m.shininess),
        })
    }

    /// Where the light of segments comes from: what the diffuse light and the highlights of a material show, with
    /// `default` where the transfer function does not say; with none, what the transfer function itself emits and
    /// hides.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`], [`OpticsError::SegmentLength`].
    pub fn preintegrated_moments(
        &self,
        n: u32,
        segment_length: f64,
        default: Option<Material>,
    ) -> Result<PreintegratedMoments, OpticsError> {
        check(n, segment_length)?;
        let channels = Channels {
            transfer: self,
            default,
            weights: |m| [m.diffuse, m.specular],
            last: |_| 1.0,
        };
        Ok(PreintegratedMoments {
            size: n,
            entries: channels.moments(n, segment_length),
        })
    }
}

/// Four channels: colour times the first weight, and `last` times the second.
struct Channels<'a> {
    transfer: &'a TransferFunction,
    /// `None`: the weights and the last are 1.
    default: Option<Material>,
    weights: fn(Material) -> [f64; 2],
    last: fn(Material) -> f64,
}

/// The two factors of each channel.
type Factors = ([f64; 4], [f64; 4]);

impl Channels<'_> {
    fn factors(&self, [r, g, b]: [f64; 3], material: Option<Material>) -> Factors {
        let [color, last] = material.map_or([1.0; 2], self.weights);
        (
            [color, color, color, last],
            [r, g, b, material.map_or(1.0, self.last)],
        )
    }

    fn at(&self, s: f64) -> [f64; 4] {
        let material = self
            .default
            .map(|default| self.transfer.material(s, default));
        product(self.factors(self.transfer.color(s), material))
    }

    /// The factors at both ends of a piece.
    fn over(&self, from: f64, to: f64) -> [Factors; 2] {
        let (color_from, color_to) = self.transfer.color.curve.over(from, to);
        let material = self
            .default
            .map(|default| self.transfer.material.over(from, to, default));
        [
            self.factors(color_from, material.map(|(from, _)| from)),
            self.factors(color_to, material.map(|(_, to)| to)),
        ]
    }

    fn knots(&self) -> Vec<f64> {
        let mut knots = self.transfer.knots();
        if self.default.is_some() {
            knots.extend(self.transfer.material.knots());
            knots.sort_by(f64::total_cmp);
            knots.dedup();
        }
        knots
    }

    fn integrals(&self, n: u32, segment_length: f64) -> Vec<[f32; 4]> {
        let cells = Cells::of_pieces(self.transfer, n, &self.knots(), |from, to, share| {
            let [low, high] = self.over(from, to);
            let profile = Profile::over(&self.transfer.absorption, from, to);
            let channels = |t| change((low, high), t);
            Piece::new(profile, share, segment_length, channels)
        });
        let constant = |i| {
            let s = node(self.transfer.range(), n, i);
            let opacity = opacity_from_extinction(self.transfer.extinction(s) * segment_length);
            self.at(s).map(|value| (value * opacity) as f32)
        };
        let stretch = |cell, cells_of_segment: f64| {
            cells
                .pieces(cell)
                .iter()
                .map(|piece| piece.stretch(segment_length / cells_of_segment))
                .fold(Stretch::EMPTY, Stretch::then)
        };
        let pack = |w: Stretch<4>, _| (w.rising.map(|v| v as f32), w.falling.map(|v| v as f32));
        tabulate(n, constant, stretch, pack)
    }

    fn moments(&self, n: u32, segment_length: f64) -> Vec<[f32; 4]> {
        // Four channels, and the same four times the place in the piece.
        let cells = Cells::of_pieces(self.transfer, n, &self.knots(), |from, to, share| {
            let [low, high] = self.over(from, to);
            let twice = |[a, b]: [[f64; 4]; 2]| -> [f64; 8] {
                std::array::from_fn(|i| if i < 4 { a[i] } else { b[i - 4] })
            };
            let profile = Profile::over(&self.transfer.absorption, from, to);
            let channels = |t: f64| {
                let (value, change) = change((low, high), t);
                let placed = [
                    value.map(|value| t * value),
                    std::array::from_fn(|i| value[i] + t * change[i]),
                ];
                (twice([value, placed[0]]), twice([change, placed[1]]))
            };
            Piece::new(profile, share, segment_length, channels)
        });
        let constant = |i| {
            let s = node(self.transfer.range(), n, i);
            let depth = self.transfer.extinction(s) * segment_length;
            let opacity = opacity_from_extinction(depth);
            // ∫₀¹ t T exp(-T t) dt
            let moment = 0.5 * opacity + seen(depth).skew;
            self.at(s).map(|value| (value * moment) as f32)
        };
        let stretch = |cell, cells_of_segment: f64| {
            cells
                .pieces(cell)
                .iter()
                .map(|piece| Placed::of_piece(piece, segment_length / cells_of_segment))
                .fold(Placed::EMPTY, Placed::then)
        };
        let pack = |w: Placed, cells: f64| -> Pair {
            let entry = |moment: [f64; 4]| moment.map(|value| (value / cells) as f32);
            (entry(w.rising_moment), entry(w.falling_moment))
        };
        tabulate(n, constant, stretch, pack)
    }
}

fn product((a, b): Factors) -> [f64; 4] {
    std::array::from_fn(|i| a[i] * b[i])
}

/// Value and change of the channels at `t` of a piece of which the factors are linear.
fn change(((a0, b0), (a1, b1)): (Factors, Factors), t: f64) -> ([f64; 4], [f64; 4]) {
    let at = |from: f64, to: f64| from + t * (to - from);
    (
        std::array::from_fn(|i| at(a0[i], a1[i]) * at(b0[i], b1[i])),
        std::array::from_fn(|i| {
            (a1[i] - a0[i]) * at(b0[i], b1[i]) + at(a0[i], a1[i]) * (b1[i] - b0[i])
        }),
    )
}

/// A stretch with the first moments of what it emits, about the end that it is seen from; lengths are in cells.
#[derive(Clone, Copy, Debug)]
struct Placed {
    stretch: Stretch<4>,
    rising_moment: [f64; 4],
    falling_moment: [f64; 4],
    cells: f64,
}

impl Placed {
    fn of_piece(piece: &Piece<8>, length: f64) -> Self {
        let whole = piece.stretch(length);
        let plain = |values: [f64; 8]| -> [f64; 4] { std::array::from_fn(|i| values[i]) };
        // Seen from the high end the place is 1 - t.
        let (rising, falling) = (whole.rising, whole.falling);
        Self {
            stretch: Stretch {
                rising: plain(rising),
                falling: plain(falling),
                depth: whole.depth,
                transmittance: whole.transmittance,
            },
            rising_moment: std::array::from_fn(|i| piece.share * rising[i + 4]),
            falling_moment: std::array::from_fn(|i| piece.share * (falling[i] - falling[i + 4])),
            cells: piece.share,
        }
    }
}

impl Composite for Placed {
    const EMPTY: Self = Self {
        stretch: Stretch::EMPTY,
        rising_moment: [0.0; 4],
        falling_moment: [0.0; 4],
        cells: 0.0,
    };

    fn then(self, next: Self) -> Self {
        let (low, high) = (&self.stretch, &next.stretch);
        // What lies behind is farther by the length of what lies in front.
        let behind_low = over(next.rising_moment, self.cells, high.rising);
        let behind_high = over(self.falling_moment, next.cells, low.falling);
        Self {
            stretch: self.stretch.then(next.stretch),
            rising_moment: over(self.rising_moment, low.transmittance, behind_low),
            falling_moment: over(next.falling_moment, high.transmittance, behind_high),
            cells: self.cells + next.cells,
        }
    }
}
