//! Error metrics between pictures, and frame times.
//!
//! The way of the data: [`compare`] takes two [`Picture`](volgraph_picture::Picture)s of one size, refuses what
//! is not a number, and gives a [`Comparison`] of plain numbers in float64 on linear premultiplied RGBA, with
//! ꟻLIP for what people see, and of depth and opacity where both have them. [`timing`] turns samples of
//! frame times into summaries, and [`order`] errors into an order of convergence, which
//! [`convergence`] tells of a whole study. Everything serialises, so that reports and tests read the same numbers.

pub mod convergence;
mod difference;
mod flip;
mod order;
pub mod timing;

pub use convergence::{Convergence, PointRole, StudyPoint};
pub use difference::{
    Channel, Comparison, ScalarDifference, WorstPixel, WorstValue, compare, compare_without_flip,
};
pub use flip::{MAX_FLIP_PIXELS, flip_mean};
pub use order::order;

use volgraph_picture::PictureError;

/// Why nothing was measured.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The pictures differ in size.
    #[error(
        "pictures of different sizes cannot be compared: {} × {} and {} × {} pixels",
        .a.0, .a.1, .b.0, .b.1
    )]
    Sizes {
        /// Width and height of the first.
        a: (u32, u32),
        /// Width and height of the second.
        b: (u32, u32),
    },
    /// A picture's buffers are not of its size.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// There are values that no difference can be taken of: NaN, and in colour and opacity the infinite too.
    #[error(
        "{buffer} is not a number in {in_a} pixels of the first picture and {in_b} of the second, \
         first at ({x}, {y}); find where it comes from before comparing"
    )]
    NotANumber {
        /// `colour`, `depth`, `opacity`, or the name of a layer.
        buffer: String,
        /// Such pixels of the first picture.
        in_a: u64,
        /// Such pixels of the second picture.
        in_b: u64,
        /// Column of the first such pixel.
        x: u32,
        /// Row of the first such pixel, from the top.
        y: u32,
    },
    /// There are no samples to summarise.
    #[error("there are no samples to summarise")]
    NoSamples,
    /// A sample is not a finite number.
    #[error("sample {index} is {value}, which is no finite number")]
    Sample {
        /// Which one, from 0.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// Alternating runs come in pairs.
    #[error("alternating runs come in pairs, but there are {a} and {b} samples")]
    Unpaired {
        /// Samples of the first.
        a: usize,
        /// Samples of the second.
        b: usize,
    },
}
