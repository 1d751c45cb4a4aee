//! The 3D pre-integrated table: the scalars at a segment's two ends and its length in, mean colour and extinction out.
//!
//! The optical depth is in proportion to the length, so that the mean extinction, which has no length, is exact at all
//! of them; and the mean colour (premultiplied colour by opacity) changes slowly, from the mean weighted by extinction
//! where the segment is short to the colour of its front where it is opaque. So few layers do. They stand closer where
//! segments are short: layer `i` of `m` is for `longest · (i / (m - 1))²`.

use rayon::prelude::*;

use super::cells::Cells;
use super::{Stretch, check, tabulate};
use crate::post::node;
use crate::{OpticsError, TransferFunction, opacity_from_extinction};

/// Mean colour and extinction of segments of any length up to a longest, for each pair of scalars at their ends.
///
/// Entries are right as those of [`PreintegratedTable`](crate::PreintegratedTable) are. Between layers, linear in the
/// square root of the length: with eight layers, segments of up to one reference length and opacities of up to 0.95
/// the premultiplied colour is off by 5e-4 at most and 5e-5 in the mean square; at the lengths of the layers, the
/// longest among them, by nothing. An opacity of 1 has an extinction of 16 and takes 16 times the length.
#[derive(Clone, Debug, PartialEq)]
pub struct PreintegratedTable3d {
    /// Entries a side, `n`, as in [`PreintegratedTable`](crate::PreintegratedTable).
    pub size: u32,
    /// Layers, `m`, from length 0 (its limit) to the longest.
    pub layers: u32,
    /// `n × n × m` entries, front fastest: `[front + n * (back + n * layer)]`. Linear RGB, the colour of the segment
    /// divided by its opacity; in the fourth place its extinction per reference length. Where nothing absorbs, the
    /// colour is the mean over the segment.
    pub entries: Vec<[f32; 4]>,
}

impl PreintegratedTable3d {
    /// One layer would not know of lengths.
    pub const MIN_LAYERS: u32 = 2;
    /// More than anybody's error needs.
    pub const MAX_LAYERS: u32 = 64;

    /// The entry for a segment from entry `front` to entry `back` in a layer.
    #[must_use]
    pub fn entry(&self, front: u32, back: u32, layer: u32) -> Option<[f32; 4]> {
        let is_inside = front < self.size && back < self.size && layer < self.layers;
        let n = self.size as usize;
        let at = front as usize + n * (back as usize + n * layer as usize);
        self.entries.get(at).filter(|_| is_inside).copied()
    }
}

/// What stands for no extinction, per reference length: seen by nobody, but with it all colours count alike where
/// nothing else does.
const NEXT_TO_NOTHING: f64 = 1e-9;

/// What stands for no length, as a share of the longest.
const NEXT_TO_NO_LENGTH: f64 = 1e-7;

impl TransferFunction {
    /// The 3D pre-integrated table with `n` entries a side, as
    /// [`preintegrated_table`](TransferFunction::preintegrated_table) has, in `layers` layers for segments of up to
    /// `longest` reference lengths.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`], [`OpticsError::Layers`], [`OpticsError::SegmentLength`].
    pub fn preintegrated_table_3d(
        &self,
        n: u32,
        layers: u32,
        longest: f64,
    ) -> Result<PreintegratedTable3d, OpticsError> {
        check(n, longest)?;
        let (min, max) = (
            PreintegratedTable3d::MIN_LAYERS,
            PreintegratedTable3d::MAX_LAYERS,
        );
        if !(min..=max).contains(&layers) {
            return Err(OpticsError::Layers {
                asked: layers,
                min,
                max,
            });
        }
        let cells = Cells::integrate(self, n, longest, NEXT_TO_NOTHING);
        // Layer by layer: what one takes in float64 is given back before the next.
        let mut entries = Vec::with_capacity((n * n * layers) as usize);
        for layer in 0..layers {
            let share = (f64::from(layer) / f64::from(layers - 1)).powi(2);
            let length = longest * share.max(NEXT_TO_NO_LENGTH);
            entries.par_extend(self.layer(&cells, n, length));
        }
        Ok(PreintegratedTable3d {
            size: n,
            layers,
            entries,
        })
    }

    fn layer(&self, cells: &Cells<super::piece::Piece<3>>, n: u32, length: f64) -> Vec<[f32; 4]> {
        let packed = |[r, g, b]: [f64; 3], extinction: f64| {
            // Rounding leaves 1e-25 of nothing, and whoever draws would no longer know it for nothing.
            let rest = extinction - NEXT_TO_NOTHING;
            let rest = if rest > 1e-6 * NEXT_TO_NOTHING {
                rest
            } else {
                0.0
            };
            [r, g, b, rest].map(|value| value as f32)
        };
        let constant = |i| {
            let s = node(self.range(), n, i);
            packed(self.color(s), self.extinction(s) + NEXT_TO_NOTHING)
        };
        let stretch = |cell, cells_of_segment| cells.stretch(cell, length / cells_of_segment);
        let pack = |window: Stretch<3>, _| {
            let per_opacity = opacity_from_extinction(window.depth).recip();
            let entry =
                |color: [f64; 3]| packed(color.map(|c| c * per_opacity), window.depth / length);
            (entry(window.rising), entry(window.falling))
        };
        tabulate(n, constant, stretch, pack)
    }
}
