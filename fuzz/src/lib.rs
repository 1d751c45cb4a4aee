//! What each fuzz target does with its bytes; the files in `fuzz_targets` only hand them over.
//!
//! The way of the data: libFuzzer makes bytes from the seeds in `seeds/TARGET` and the words in
//! `dictionaries/TARGET.dict`; a function here feeds them to one parser and, where that is content, uses what it
//! gave in the way the rest of volgraph does. Formats of several files have them in one input, with lines between them,
//! and are read from a folder in memory. A target fails by a panic, by what the address sanitiser sees, by one
//! input that takes seconds, or by an allocation of hundreds of MiB: inputs have some KiB, so nothing they say can be
//! worth so much. `cargo xtask fuzz` runs all targets with those limits.

mod folder;
mod folders;
mod forgive;
mod meshes;
#[cfg(test)]
mod tests;
mod text;
mod volumes;

pub use folders::{bricks, zarr};
pub use forgive::{forgive_decoders, forgive_naga};
pub use meshes::mesh;
pub use text::{graph, plan, shader, transfer};
pub use volumes::{
    dicom, hdf5, metaimage, nifti, npy, nrrd, pictures, raw_name, recognise, tiff, vti, zarr_zip,
};
