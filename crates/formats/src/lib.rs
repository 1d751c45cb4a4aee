//! Volumes in files: readers, series, writers.
//!
//! The way of the data: [`VolumeReader::open`] takes a file, a folder or a glob, looks at the first bytes of each
//! file and picks one row of the table of formats (`format`). Its module reads the header into `contents`
//! (plain values: axes, placement, units), checks them against the file's true length and leaves a `Data`, the way to
//! the voxels. [`VolumeReader::read`] then takes one time step: the voxels of all components come in, growing with
//! what the file really holds, and `pick` makes one scalar per voxel of them. [`load`] is both at once.
//!
//! A new format is a module with one function from inputs to `Opened`, and a row in the table. What has a crate of
//! its own is parsed by that crate; the bounds on what may be allocated are ours.
//!
//! Every refusal is a [`VolumeError`](volgraph_volume::VolumeError) that names the file, the header line where there
//! is one, the cause and the remedy. Volumes are placed in the world frame LPS (see `volgraph-volume`).

mod axes;
pub mod bricks;
mod choice;
mod contents;
mod data_files;
mod dicom;
mod fields;
mod format;
mod hdf5;
mod input;
mod load;
pub mod metaimage;
mod nifti;
mod npy;
pub mod nrrd;
mod pick;
mod piece;
pub mod raw;
mod reader;
mod rescale;
mod series;
mod slices;
mod stack;
mod stored;
mod stream;
mod text_data;
mod tiff;
mod vti;
mod write;
pub mod zarr;

pub use data_files::DataFiles;
pub use format::is_volume;
pub use load::{LoadOptions, Progress, from_bytes, load};
pub use piece::Encoding;
pub use raw::{RawName, parse_raw_name};
pub use reader::VolumeReader;
pub use write::{Compression, FileFormat, WriteOptions, Written, write};
