//! NIfTI, VTI, NumPy and HDF5 against what nibabel, VTK and NumPy (`make_expected_nifti_vti_npy.py`), h5py, netCDF4,
//! xarray and SimpleITK read (`make_hdf5.py`).
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::expected::compare_all;

#[test]
fn nifti_reads_as_nibabel_reads_it() {
    if !compare_all(include_str!("expected_nifti.tsv")) {
        println!("no shared test data: the files of other software were not read");
    }
}

#[test]
fn vti_reads_as_vtk_reads_it() {
    if !compare_all(include_str!("expected_vti.tsv")) {
        println!("no shared test data: the files of other software were not read");
    }
}

#[test]
fn npy_reads_as_numpy_reads_it() {
    if !compare_all(include_str!("expected_npy.tsv")) {
        println!("no shared test data: the files of other software were not read");
    }
}

#[test]
fn hdf5_reads_as_its_writers_read_it() {
    compare_all(include_str!("expected_hdf5.tsv"));
}
