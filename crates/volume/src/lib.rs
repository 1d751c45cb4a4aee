//! Volumes: grids, readers, statistics, analytic fields.
//!
//! The way of the data: [`Volume::load`] looks at a file's first bytes and hands it to one reader ([`raw`],
//! [`nrrd`], [`metaimage`]). A reader turns the header into plain values, checks them (sizes, placement, file
//! length, the memory limit) and only then lets the voxels be read, growing with what the file really holds.
//! The result is a [`Volume`]: typed [`Voxels`] on a [`Grid`], placed in the world by one affine map. Digest and
//! [`Statistics`] are computed when first asked for. [`analytic`] makes volumes of known functions instead.
//! Every refusal is a [`VolumeError`] that names the file, the header line, the cause and the remedy.
//!
//! **The world frame is LPS**: x grows to the patient's left, y to posterior, z to superior, as in DICOM and
//! ITK. NRRD files in RAS or LAS are converted; MetaImage is LPS already; raw files have no frame of their own.
//! Lengths are in the file's own unit (millimetres in most medical files).

pub mod analytic;
mod axes;
mod brick_details;
mod bricks;
mod data_files;
mod error;
mod fields;
mod grid;
mod input;
mod load;
pub mod metaimage;
pub mod nrrd;
mod piece;
pub mod raw;
mod scalar;
mod statistics;
mod steepness;
mod stream;
mod text_data;
mod volume;
mod voxels;

pub use brick_details::BrickDetails;
pub use bricks::{BrickRanges, brick_dims};
pub use data_files::DataFiles;
pub use error::{Trouble, VolumeError};
pub use grid::Grid;
pub use load::{DEFAULT_MAX_BYTES, LoadOptions, Progress};
pub use piece::Encoding;
pub use raw::{RawName, parse_raw_name};
pub use scalar::ScalarType;
pub use statistics::{Histogram, Statistics};
pub use volume::{Digest, Volume};
pub use voxels::{Element, Voxels};
