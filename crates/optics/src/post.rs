//! The table for post-classification: one scalar in, colour and extinction out.

use crate::{OpticsError, TransferFunction, opacity_from_extinction};

/// Colour and extinction at even places over the transfer function's range.
#[derive(Clone, Debug, PartialEq)]
pub struct PostTable {
    /// Entry `i` of `n` is at `lo + i / (n - 1) · (hi - lo)`: linear RGB, not premultiplied, and in the fourth
    /// place the extinction per reference length.
    pub entries: Vec<[f32; 4]>,
}

impl PostTable {
    /// Fewer entries than this would show as bands.
    pub const MIN_SIZE: u32 = 1024;
    /// What every device takes as a 1D or 2D texture's width.
    pub const MAX_SIZE: u32 = 8192;

    /// Whether a table over one scalar may have so many entries.
    pub(crate) fn check_size(asked: u32, table: &'static str) -> Result<(), OpticsError> {
        let (min, max) = (Self::MIN_SIZE, Self::MAX_SIZE);
        if (min..=max).contains(&asked) {
            return Ok(());
        }
        Err(OpticsError::TableSize {
            table,
            asked,
            min,
            max,
        })
    }
}

impl TransferFunction {
    /// The table for post-classification with `n` entries, [`PostTable::MIN_SIZE`] to [`PostTable::MAX_SIZE`].
    ///
    /// # Errors
    /// [`OpticsError::TableSize`].
    pub fn post_table(&self, n: u32) -> Result<PostTable, OpticsError> {
        PostTable::check_size(n, "post-classification")?;
        let entry = |i| {
            let s = node(self.range(), n, i);
            let [r, g, b] = self.color(s).map(|c| c as f32);
            [r, g, b, self.extinction(s) as f32]
        };
        Ok(PostTable {
            entries: (0..n).map(entry).collect(),
        })
    }

    /// What a segment of `segment_length` reference lengths of one scalar emits towards its front (linear RGB,
    /// premultiplied, attenuated by the segment itself), and the transmittance of the segment: at the same scalars as in
    /// [`post_table`](Self::post_table), as many.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`], [`OpticsError::SegmentLength`].
    pub fn step_table(&self, n: u32, segment_length: f64) -> Result<Vec<[f32; 4]>, OpticsError> {
        PostTable::check_size(n, "classification of steps")?;
        if !(segment_length.is_finite() && segment_length > 0.0) {
            return Err(OpticsError::SegmentLength(segment_length));
        }
        let entry = |i| {
            let s = node(self.range(), n, i);
            let depth = self.extinction(s) * segment_length;
            let opacity = opacity_from_extinction(depth);
            let [r, g, b] = self.color(s).map(|c| (c * opacity) as f32);
            [r, g, b, (-depth).exp() as f32]
        };
        Ok((0..n).map(entry).collect())
    }

    /// The refractive index at even places over the range, as many and at the same scalars as in
    /// [`post_table`](Self::post_table).
    ///
    /// # Errors
    /// [`OpticsError::TableSize`].
    pub fn refraction_table(&self, n: u32) -> Result<Vec<f32>, OpticsError> {
        PostTable::check_size(n, "refraction")?;
        let entry = |i| self.refractive_index(node(self.range(), n, i)) as f32;
        Ok((0..n).map(entry).collect())
    }
}

/// The scalar of entry `i` of `n ≥ 2`; the last is exactly the range's end.
pub(crate) fn node((lo, hi): (f64, f64), n: u32, i: u32) -> f64 {
    if i + 1 >= n {
        hi
    } else {
        lo + f64::from(i) / f64::from(n - 1) * (hi - lo)
    }
}
