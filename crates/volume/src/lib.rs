//! Volumes: grids, voxels, statistics, analytic fields.
//!
//! A [`Volume`] is typed [`Voxels`] on a [`Grid`], placed in the world by one affine map; [`About`] is what its file
//! says of it beside that: units, what the values mean, which of several components or steps it is. Digest and
//! [`Statistics`] are computed when first asked for. [`analytic`] makes volumes of known functions; the crate
//! `volgraph-formats` reads and writes files. Every refusal is a [`VolumeError`] that names the file, the header
//! line, the cause and the remedy.
//!
//! **The world frame is LPS**: x grows to the patient's left, y to posterior, z to superior, as in DICOM and ITK.
//! Readers turn RAS and LAS into it; raw files have no frame of their own. Lengths are in the file's own unit
//! (millimetres in most medical files, [`About::length_unit`] where it is said).

mod about;
pub mod analytic;
mod brick_details;
mod bricks;
pub mod edit;
mod error;
mod grid;
mod scalar;
mod statistics;
mod steepness;
mod volume;
mod voxels;

pub use about::{About, Component, Picked, Step, Values};
pub use brick_details::BrickDetails;
pub use bricks::{BrickRanges, brick_dims};
pub use error::{Trouble, VolumeError};
pub use grid::Grid;
pub use scalar::ScalarType;
pub use statistics::{Histogram, Statistics};
pub use volume::{DEFAULT_MAX_BYTES, Digest, Volume, drawn};
pub use voxels::{Element, Voxels};
