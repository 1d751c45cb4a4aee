//! Volumes larger than memory: levels of bricks, read where they lie.
//!
//! [`build()`] makes the pyramid of a volume once: coarser levels as an OME-Zarr folder beside it
//! ([`pyramid_path`]), with the range of each brick and its exact error against level 0. [`BrickStore::open`] then
//! gives bricks of any level on demand, to any number of threads:
//!
//! 1. [`BrickStore::levels`] say how many samples and bricks there are, and where they lie in the world;
//! 2. [`BrickStore::brick_info`] says what is worth a read: bricks whose range is transparent are passed over, and a
//!    coarse brick whose error is small enough need not be refined;
//! 3. [`BrickStore::read_brick_into`] fills a slice of a staging buffer with the brick and its apron.
//!
//! Level 0 stays in its file: raw voxels, uncompressed NRRD, MetaImage, NIfTI and NumPy with one value per voxel in one
//! run, and Zarr folders, whose own coarser levels are taken where they halve. Everything else is converted first.

mod build;
mod cache;
mod chunks;
mod field;
mod halve;
mod levels;
mod plan;
mod side;
mod source;
mod store;
mod survey;
mod tables;
mod tally;

use volgraph_volume::Histogram;

pub use build::{BuildOptions, Built, build};
pub(crate) use field::read_at;
pub use levels::BrickLevel;
pub use source::pyramid_path;
pub use store::{BrickStore, StoreOptions};

/// Voxels along each edge of a brick without its apron, unless it is told otherwise.
pub const DEFAULT_EDGE: u32 = 32;

/// What is known of a brick without reading it. Numbers were rounded to float32, outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrickInfo {
    /// Least value of the brick and its apron, and so of everything that trilinear filtering gives inside of it. What
    /// is not finite counts as what is [drawn](BrickStore::drawn) for it.
    pub min: f64,
    /// Largest value of the brick and its apron.
    pub max: f64,
    /// Root mean square, over all samples of level 0 whose centres are in the brick's box, of the difference between
    /// this level there (trilinear, what is drawn) and the sample (what is drawn); in data units. Exact but for
    /// rounding; 0 on level 0.
    pub rms_error: f64,
    /// The largest of these differences.
    pub max_error: f64,
}

/// What the voxels of level 0 are like. Where none is finite, `min`, `max`, `mean` and `standard_deviation` are
/// not-a-number.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickStatistics {
    /// Smallest finite value.
    pub min: f64,
    /// Largest finite value.
    pub max: f64,
    /// Mean of the finite values.
    pub mean: f64,
    /// Standard deviation of the finite values.
    pub standard_deviation: f64,
    /// Voxels with a finite value.
    pub finite_count: u64,
    /// Voxels that are not a number.
    pub nan_count: u64,
    /// Voxels that are plus infinity.
    pub positive_infinity_count: u64,
    /// Voxels that are minus infinity.
    pub negative_infinity_count: u64,
    /// 4096 bins over the finite range.
    pub histogram: Histogram,
}

impl Default for BrickStatistics {
    fn default() -> Self {
        Self {
            min: f64::NAN,
            max: f64::NAN,
            mean: f64::NAN,
            standard_deviation: f64::NAN,
            finite_count: 0,
            nan_count: 0,
            positive_infinity_count: 0,
            negative_infinity_count: 0,
            histogram: Histogram {
                lo: 0.0,
                hi: 0.0,
                counts: Vec::new(),
            },
        }
    }
}

impl BrickStatistics {
    /// Smallest and largest finite value; `None` where there is none.
    #[must_use]
    pub fn range(&self) -> Option<(f64, f64)> {
        (self.finite_count > 0).then_some((self.min, self.max))
    }
}
