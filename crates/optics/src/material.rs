//! What a scalar makes of light: the fractions that a transfer function's `material` gives.
//!
//! Each fraction is a curve of its own through the control points that give it. Where none does, the fraction is
//! what the caller states, so that one file serves pictures with materials of their own.

use crate::curve::Curve;
use crate::post::node;
use crate::{OpticsError, PostTable, TransferFunction};

/// What a point makes of light (Phong's model, in Blinn's form).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Share of the colour that needs no light, 0 to 1.
    pub ambient: f64,
    /// Share of the colour that the light gives, 0 to 1.
    pub diffuse: f64,
    /// Strength of the highlight, 0 to 1.
    pub specular: f64,
    /// Sharpness of the highlight: the exponent of its cosine, 1 to 256.
    pub shininess: f64,
}

impl Material {
    pub(crate) const NAMES: [&'static str; 4] = ["ambient", "diffuse", "specular", "shininess"];
    /// The most that each of them may be, and the least.
    pub(crate) const BOUNDS: [(f64, f64); 4] = [(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (1.0, 256.0)];

    fn values(self) -> [f64; 4] {
        [self.ambient, self.diffuse, self.specular, self.shininess]
    }

    fn from_values([ambient, diffuse, specular, shininess]: [f64; 4]) -> Self {
        Self {
            ambient,
            diffuse,
            specular,
            shininess,
        }
    }
}

/// A control point as the file gives it: position, and the values of [`Material::NAMES`] that it has.
pub(crate) type MaterialPoint = (f64, [Option<f64>; 4]);

/// The field `material`; without control points where the file has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MaterialField {
    points: Vec<MaterialPoint>,
    curves: [Option<Curve<1>>; 4],
}

impl MaterialField {
    /// `points` are finite and in order; the reader has seen to it.
    pub(crate) fn new(points: Vec<MaterialPoint>) -> Self {
        let curves = std::array::from_fn(|value| {
            let given: Vec<_> = points
                .iter()
                .filter_map(|(at, values)| Some((*at, [values[value]?])))
                .collect();
            (!given.is_empty()).then(|| Curve::new(given))
        });
        Self { points, curves }
    }

    pub(crate) fn points(&self) -> &[MaterialPoint] {
        &self.points
    }

    /// Those of the values that have one.
    pub(crate) fn curves(&self) -> impl Iterator<Item = &Curve<1>> {
        self.curves.iter().flatten()
    }

    pub(crate) fn knots(&self) -> Vec<f64> {
        self.curves().flat_map(Curve::knots).collect()
    }

    pub(crate) fn at(&self, s: f64, default: Material) -> Material {
        let given = default.values();
        Material::from_values(std::array::from_fn(|i| match &self.curves[i] {
            Some(curve) => curve.at(s)[0],
            None => given[i],
        }))
    }

    /// The values at both ends of a piece without a knot inside, as [`Curve::over`].
    pub(crate) fn over(&self, from: f64, to: f64, default: Material) -> (Material, Material) {
        let given = default.values();
        let ends: [(f64, f64); 4] = std::array::from_fn(|i| match &self.curves[i] {
            Some(curve) => {
                let ([a], [b]) = curve.over(from, to);
                (a, b)
            }
            None => (given[i], given[i]),
        });
        (
            Material::from_values(ends.map(|(a, _)| a)),
            Material::from_values(ends.map(|(_, b)| b)),
        )
    }
}

impl TransferFunction {
    /// Whether its file says anything about the material.
    #[must_use]
    pub fn has_material(&self) -> bool {
        !self.material.points().is_empty()
    }

    /// What a scalar makes of light, at a step the later point's; `default` where the transfer function does not say.
    #[must_use]
    pub fn material(&self, s: f64, default: Material) -> Material {
        self.material.at(s, default)
    }

    /// The material at `n` even places over the range ([`PostTable::MIN_SIZE`] to [`PostTable::MAX_SIZE`]), as
    /// [`PostTable`] has colour: ambient, diffuse, specular, shininess.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`].
    pub fn material_table(&self, n: u32, default: Material) -> Result<Vec<[f32; 4]>, OpticsError> {
        PostTable::check_size(n, "material")?;
        Ok((0..n)
            .map(|i| {
                self.material(node(self.range(), n, i), default)
                    .values()
                    .map(|value| value as f32)
            })
            .collect())
    }
}
