//! The transfer function: colour and extinction of a scalar.
//!
//! A file (or text) is read once into two curves, one of colour and one of opacity or extinction; both are
//! evaluated in float64 wherever someone asks. Its canonical RON text is also what its digest is taken of.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use volgraph_report::{Finding, Findings, Place};

use crate::curve::Curve;
use crate::file;
use crate::material::{Material, MaterialField};

/// Extinction per reference length that opacity 1 stands for: it leaves a transmittance of 1.1e-7.
pub const MAX_EXTINCTION_FROM_OPACITY: f64 = 16.0;

/// Extinction per reference length of an opacity in 0..=1: `-ln(1 - α)`, at most
/// [`MAX_EXTINCTION_FROM_OPACITY`].
#[must_use]
pub fn extinction_from_opacity(opacity: f64) -> f64 {
    (-(-opacity).ln_1p()).min(MAX_EXTINCTION_FROM_OPACITY)
}

/// Opacity of an optical depth: `1 - exp(-τ)`.
#[must_use]
pub fn opacity_from_extinction(extinction: f64) -> f64 {
    -(-extinction).exp_m1()
}

/// The unit of the control points' positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Domain {
    /// 0..1 over the range of the volume's stored type.
    Normalised,
    /// 0..1 over the values that the volume has.
    Range,
    /// The volume's own data values (Hounsfield units, for instance).
    Data,
}

/// The length that an opacity, or an extinction of 1, is stated for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceLength {
    /// So many voxels of the volume's smallest spacing.
    Voxels(f64),
    /// So many units of world space.
    World(f64),
}

impl ReferenceLength {
    /// The reference length in world units, for a volume whose smallest spacing is `min_spacing_world`.
    #[must_use]
    pub fn in_world(self, min_spacing_world: f64) -> f64 {
        match self {
            Self::Voxels(voxels) => voxels * min_spacing_world,
            Self::World(world) => world,
        }
    }

    /// The factor that turns extinction per reference length into extinction per world unit.
    #[must_use]
    pub fn extinction_per_world(self, min_spacing_world: f64) -> f64 {
        self.in_world(min_spacing_world).recip()
    }
}

/// Where the colours come from; the curve is what counts, the name is for the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ColorSource {
    pub(crate) curve: Curve<3>,
    pub(crate) map: Option<MapUse>,
}

/// A named colour map laid over the scalars `from..to`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MapUse {
    pub(crate) name: String,
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) is_reversed: bool,
}

/// What is interpolated linearly between control points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Absorption {
    /// Opacity of one reference length.
    Opacity(Curve<1>),
    /// Extinction per reference length.
    Extinction(Curve<1>),
}

impl Absorption {
    pub(crate) fn curve(&self) -> &Curve<1> {
        match self {
            Self::Opacity(curve) | Self::Extinction(curve) => curve,
        }
    }
}

/// A transfer function: linear RGB and extinction per reference length of every scalar.
///
/// Scalars are in the units of [`domain`](Self::domain); beyond the first and last control point their values hold.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    pub(crate) domain: Domain,
    pub(crate) range: (f64, f64),
    pub(crate) reference_length: ReferenceLength,
    pub(crate) color: ColorSource,
    pub(crate) absorption: Absorption,
    /// `None` where the file has none: 1 everywhere.
    pub(crate) refraction: Option<Curve<1>>,
    pub(crate) material: MaterialField,
}

/// A transfer function where it is smooth: between two neighbouring knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    from: f64,
    per_scalar: f64,
    color: ([f64; 3], [f64; 3]),
    absorption: (f64, f64),
    is_opacity: bool,
}

impl Smooth {
    /// Linear RGB and extinction per reference length of a scalar.
    #[must_use]
    pub fn at(&self, s: f64) -> ([f64; 3], f64) {
        let w = ((s - self.from) * self.per_scalar).clamp(0.0, 1.0);
        let (low, high) = &self.color;
        let color = std::array::from_fn(|i| low[i] + w * (high[i] - low[i]));
        let absorption = self.absorption.0 + w * (self.absorption.1 - self.absorption.0);
        if self.is_opacity {
            (color, extinction_from_opacity(absorption))
        } else {
            (color, absorption)
        }
    }

    /// Whether nothing of it absorbs.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.absorption == (0.0, 0.0)
    }
}

/// Open intervals as few that are apart, rising: those that overlap are one.
#[must_use]
pub fn union(mut intervals: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    intervals.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut apart: Vec<(f64, f64)> = Vec::new();
    for (from, to) in intervals {
        match apart.last_mut() {
            Some(before) if from < before.1 => before.1 = before.1.max(to),
            _ => apart.push((from, to)),
        }
    }
    apart
}

/// A material where it is smooth: between two neighbouring knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothMaterial {
    from: f64,
    per_scalar: f64,
    ends: (Material, Material),
}

impl SmoothMaterial {
    /// One material of all scalars.
    #[must_use]
    pub fn uniform(material: Material) -> Self {
        Self {
            from: 0.0,
            per_scalar: 0.0,
            ends: (material, material),
        }
    }

    /// The material of a scalar.
    #[must_use]
    pub fn at(&self, s: f64) -> Material {
        let w = ((s - self.from) * self.per_scalar).clamp(0.0, 1.0);
        let (low, high) = &self.ends;
        let mix = |a: f64, b: f64| a + w * (b - a);
        Material {
            ambient: mix(low.ambient, high.ambient),
            diffuse: mix(low.diffuse, high.diffuse),
            specular: mix(low.specular, high.specular),
            shininess: mix(low.shininess, high.shininess),
        }
    }
}

impl TransferFunction {
    /// Reads a text in the grammar of [`mod@crate::file`]; `file` is the name that findings carry.
    ///
    /// # Errors
    /// Everything wrong in it, each with its place.
    pub fn parse(file: &Path, text: &str) -> Result<Self, Findings> {
        file::parse(file, text)
    }

    /// Reads a file in the grammar of [`mod@crate::file`], of at most 256 KiB.
    ///
    /// # Errors
    /// `io` where it cannot be read, else as [`parse`](Self::parse).
    pub fn load(path: &Path) -> Result<Self, Findings> {
        let unreadable = |error: std::io::Error| {
            Finding::error(
                "io",
                format!("the transfer function cannot be read: {error}"),
            )
            .at(Place::whole_file(path))
            .help("check that the path names a UTF-8 text file that you may read")
        };
        let metadata = fs::metadata(path).map_err(unreadable)?;
        if !metadata.is_file() {
            // Reading a pipe or a device might never end.
            let error = std::io::Error::other("it is no plain file");
            return Err(unreadable(error).into());
        }
        let mut text = String::new();
        // One byte more than allowed is enough for `parse` to refuse it by size.
        let limit = file::MAX_TEXT_BYTES as u64 + 1;
        File::open(path)
            .and_then(|file| file.take(limit).read_to_string(&mut text))
            .map_err(unreadable)?;
        Self::parse(path, &text)
    }

    /// The canonical text in the grammar of [`mod@crate::file`]; reading it gives an equal transfer function.
    #[must_use]
    pub fn to_ron(&self) -> String {
        file::write(self)
    }

    /// BLAKE3 of the canonical text: comments, layout and the way a colour is written do not change it.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        *blake3::hash(self.to_ron().as_bytes()).as_bytes()
    }

    /// The unit of its scalars.
    #[must_use]
    pub fn domain(&self) -> Domain {
        self.domain
    }

    /// The scalars `(lo, hi)` that the tables span, `lo < hi`, in the units of the domain.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// The length that its extinction is stated for.
    #[must_use]
    pub fn reference_length(&self) -> ReferenceLength {
        self.reference_length
    }

    /// Linear RGB, not multiplied by anything, of a scalar; at a step the later point's.
    #[must_use]
    pub fn color(&self, s: f64) -> [f64; 3] {
        self.color.curve.at(s)
    }

    /// Extinction per reference length of a scalar; at a step the later point's.
    #[must_use]
    pub fn extinction(&self, s: f64) -> f64 {
        let [value] = self.absorption.curve().at(s);
        match &self.absorption {
            Absorption::Opacity(_) => extinction_from_opacity(value),
            Absorption::Extinction(_) => value,
        }
    }

    /// Opacity of one reference length of a scalar: `1 - exp(-extinction)`.
    #[must_use]
    pub fn opacity(&self, s: f64) -> f64 {
        opacity_from_extinction(self.extinction(s))
    }

    /// Colour and extinction between two neighbours of [`knots`](Self::knots), or beyond the outermost: what a step at
    /// either end is on the other side does not show.
    #[must_use]
    pub fn smooth(&self, from: f64, to: f64) -> Smooth {
        let (color_from, color_to) = self.color.curve.over(from, to);
        let ([absorption_from], [absorption_to]) = self.absorption.curve().over(from, to);
        Smooth {
            from,
            per_scalar: if to > from { (to - from).recip() } else { 0.0 },
            color: (color_from, color_to),
            absorption: (absorption_from, absorption_to),
            is_opacity: matches!(self.absorption, Absorption::Opacity(_)),
        }
    }

    /// The material between two neighbours of all knots, these and [`material_knots`](Self::material_knots), or beyond
    /// the outermost; `default` where the transfer function does not say.
    #[must_use]
    pub fn smooth_material(&self, from: f64, to: f64, default: Material) -> SmoothMaterial {
        SmoothMaterial {
            from,
            per_scalar: if to > from { (to - from).recip() } else { 0.0 },
            ends: self.material.over(from, to, default),
        }
    }

    /// The scalars, in no order, between which the material is smooth.
    #[must_use]
    pub fn material_knots(&self) -> Vec<f64> {
        self.material.knots()
    }

    /// Where anything absorbs: open intervals of scalars, rising and apart. Beyond its [range](Self::range) what is at the
    /// range's ends holds. An interval's end where the extinction rises from 0 absorbs nothing and is no part of it; one
    /// where it starts at once is, by an interval that is longer by a rounding.
    #[must_use]
    pub fn absorbing(&self) -> Vec<(f64, f64)> {
        let (low, high) = self.range;
        let mut knots: Vec<f64> = self.absorption.curve().knots();
        knots.retain(|knot| low < *knot && *knot < high);
        knots.insert(0, low);
        knots.push(high);
        let mut spans: Vec<(f64, f64)> = Vec::new();
        for pair in knots.windows(2) {
            let smooth = self.smooth(pair[0], pair[1]);
            let [first, last] = [pair[0], pair[1]].map(|at| smooth.at(at).1 > 0.0);
            if !(first || last) {
                continue;
            }
            let from = match first {
                true if pair[0] <= low => f64::NEG_INFINITY,
                true => pair[0].next_down(),
                false => pair[0],
            };
            let to = match last {
                true if pair[1] >= high => f64::INFINITY,
                true => pair[1].next_up(),
                false => pair[1],
            };
            spans.push((from, to));
        }
        union(spans)
    }

    /// Refractive index of a scalar, 1 to 4; at a step the later point's. 1 where the file does not say.
    #[must_use]
    pub fn refractive_index(&self, s: f64) -> f64 {
        self.refraction.as_ref().map_or(1.0, |curve| curve.at(s)[0])
    }

    /// The first and the last scalar between which the refractive index changes at all; `None` where it is the same
    /// everywhere.
    #[must_use]
    pub fn refraction_span(&self) -> Option<(f64, f64)> {
        let points = self.refraction.as_ref()?.points();
        let changes = |pair: &&[(f64, [f64; 1])]| pair[0].1 != pair[1].1;
        let first = points.windows(2).find(changes)?;
        let last = points.windows(2).rfind(changes)?;
        Some((first[0].0, last[1].0))
    }

    /// The least and the most that each channel of its colours is, over all scalars.
    #[must_use]
    pub fn color_bounds(&self) -> [[f64; 3]; 2] {
        let colors = || self.color.curve.points().iter().map(|(_, color)| *color);
        let most = |sign: f64| {
            colors().fold([-f64::INFINITY; 3], |best: [f64; 3], color| {
                std::array::from_fn(|i| best[i].max(sign * color[i]))
            })
        };
        [most(-1.0).map(|value| -value), most(1.0)]
    }

    /// The scalars, rising, each once, between which colour and extinction are smooth: the control points, the
    /// samples of a colour map, and where a rising opacity meets its cap. They may lie outside the range.
    #[must_use]
    pub fn knots(&self) -> Vec<f64> {
        let absorption = self.absorption.curve().points();
        let mut knots = self.color.curve.knots();
        knots.extend(self.absorption.curve().knots());
        if matches!(self.absorption, Absorption::Opacity(_)) {
            let cap = opacity_from_extinction(MAX_EXTINCTION_FROM_OPACITY);
            for pair in absorption.windows(2) {
                let ((from, [a]), (to, [b])) = (pair[0], pair[1]);
                if (a < cap) != (b < cap) {
                    knots.push((from + (cap - a) / (b - a) * (to - from)).clamp(from, to));
                }
            }
        }
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        knots
    }
}
