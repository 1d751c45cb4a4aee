//! What scalars are made of: a transfer function in the units of a volume, as smooth parts between knots.

use volgraph_optics::{Smooth, TransferFunction};

/// A transfer function as a function of data values.
#[derive(Clone, Debug)]
pub struct Matter {
    /// Data values, rising, each once, between which colour and extinction are smooth.
    knots: Vec<f64>,
    /// One more than there are knots.
    parts: Vec<Smooth>,
    /// position = (value - low) / span, in the transfer function's own units.
    low: f64,
    span: f64,
    /// The positions that tables span; beyond them the ends hold.
    range: (f64, f64),
    extinction_per_world: f64,
    digest: [u8; 32],
}

impl Matter {
    /// A transfer function whose positions 0 and 1 stand for the data values `low` and `low + span`, for a volume whose
    /// smallest spacing is `min_spacing` world units.
    #[must_use]
    pub fn new(transfer: &TransferFunction, (low, span): (f64, f64), min_spacing: f64) -> Self {
        let range = transfer.range();
        let mut positions: Vec<f64> = transfer
            .knots()
            .into_iter()
            .filter(|knot| range.0 < *knot && *knot < range.1)
            .collect();
        positions.insert(0, range.0);
        positions.push(range.1);
        let mut parts = vec![transfer.smooth(range.0, range.0)];
        parts.extend(
            positions
                .windows(2)
                .map(|pair| transfer.smooth(pair[0], pair[1])),
        );
        parts.push(transfer.smooth(range.1, range.1));
        Self {
            knots: positions.iter().map(|at| low + at * span).collect(),
            parts,
            low,
            span,
            range,
            extinction_per_world: transfer
                .reference_length()
                .extinction_per_world(min_spacing),
            digest: transfer.digest(),
        }
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
        self.parts[part].is_clear()
    }

    /// Linear RGB and extinction per world unit of a data value, as of that part.
    #[must_use]
    pub fn at(&self, part: usize, value: f64) -> ([f64; 3], f64) {
        let position = ((value - self.low) / self.span).clamp(self.range.0, self.range.1);
        let (color, extinction) = self.parts[part].at(position);
        (color, extinction * self.extinction_per_world)
    }

    /// Digest of the transfer function, of its units and its reference length.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&self.digest);
        for number in [self.low, self.span, self.extinction_per_world] {
            hasher.update(&number.to_le_bytes());
        }
        *hasher.finalize().as_bytes()
    }
}
