//! What scalars are made of: a transfer function in the units of a volume, as smooth parts between knots.

use volgraph_optics::{Material, Smooth, SmoothMaterial, TransferFunction};

/// A transfer function as a function of data values.
#[derive(Clone, Debug, PartialEq)]
pub struct Matter {
    /// Data values, rising, each once, between which everything is smooth.
    knots: Vec<f64>,
    /// One more than there are knots.
    parts: Vec<(Smooth, SmoothMaterial)>,
    /// position = (value - low) / span, in the transfer function's own units.
    low: f64,
    span: f64,
    /// The positions that tables span; beyond them the ends hold.
    range: (f64, f64),
    extinction_per_world: f64,
    /// The largest component of its colours.
    brightest: f64,
}

/// What a point makes of light, where the transfer function says and where it does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Materials {
    /// That of everything, or of what the transfer function does not speak of.
    pub default: Material,
    /// Whether the transfer function is asked.
    pub by_transfer: bool,
}

impl Materials {
    /// Of what is not lit, where nobody asks.
    pub const NONE: Self = Self {
        default: Material {
            ambient: 1.0,
            diffuse: 0.0,
            specular: 0.0,
            shininess: 1.0,
        },
        by_transfer: false,
    };
}

impl Matter {
    /// A transfer function whose positions 0 and 1 stand for the data values `low` and `low + span`, for a volume whose
    /// smallest spacing is `min_spacing` world units.
    #[must_use]
    pub fn new(
        transfer: &TransferFunction,
        (low, span): (f64, f64),
        min_spacing: f64,
        materials: &Materials,
    ) -> Self {
        let range = transfer.range();
        let mut positions = transfer.knots();
        if materials.by_transfer {
            positions.extend(transfer.material_knots());
        }
        positions.retain(|knot| range.0 < *knot && *knot < range.1);
        positions.extend([range.0, range.1]);
        positions.sort_by(f64::total_cmp);
        positions.dedup();
        let part = |from: f64, to: f64| {
            let material = if materials.by_transfer {
                transfer.smooth_material(from, to, materials.default)
            } else {
                SmoothMaterial::uniform(materials.default)
            };
            (transfer.smooth(from, to), material)
        };
        let mut parts = vec![part(range.0, range.0)];
        parts.extend(positions.windows(2).map(|pair| part(pair[0], pair[1])));
        parts.push(part(range.1, range.1));
        Self {
            knots: positions.iter().map(|at| low + at * span).collect(),
            parts,
            low,
            span,
            range,
            extinction_per_world: transfer
                .reference_length()
                .extinction_per_world(min_spacing),
            brightest: transfer.color_bounds()[1].into_iter().fold(0.0, f64::max),
        }
    }

    /// The largest component of its colours.
    #[must_use]
    pub fn brightest(&self) -> f64 {
        self.brightest
    }

    /// The data values between which everything is smooth.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The part that a value between two knots is in.
    #[must_use]
    pub fn part_of(&self, value: f64) -> usize {
        self.knots.partition_point(|knot| *knot <= value)
    }

    /// Whether nothing in a part absorbs.
    #[must_use]
    pub fn is_clear(&self, part: usize) -> bool {
        self.parts[part].0.is_clear()
    }

    fn position(&self, value: f64) -> f64 {
        ((value - self.low) / self.span).clamp(self.range.0, self.range.1)
    }

    /// Linear RGB and extinction per world unit of a data value, as of that part.
    #[must_use]
    pub fn at(&self, part: usize, value: f64) -> ([f64; 3], f64) {
        let (color, extinction) = self.parts[part].0.at(self.position(value));
        (color, extinction * self.extinction_per_world)
    }

    /// What a data value makes of light, as of that part.
    #[must_use]
    pub fn material(&self, part: usize, value: f64) -> Material {
        self.parts[part].1.at(self.position(value))
    }

    /// Linear RGB of a data value, and its opacity over one reference length.
    #[must_use]
    pub fn over_reference(&self, value: f64) -> ([f64; 3], f64) {
        let smooth = &self.parts[self.part_of(value)].0;
        let (color, extinction) = smooth.at(self.position(value));
        (color, -(-extinction).exp_m1())
    }
}
