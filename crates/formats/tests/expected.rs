//! NIfTI, VTI and NumPy against what nibabel, VTK and NumPy read (`make_expected_nifti_vti_npy.py`).
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::expected::compare_all;

#[test]
fn nifti_reads_as_nibabel_reads_it() {
    compare_all(include_str!("expected_nifti.tsv"));
}

#[test]
fn vti_reads_as_vtk_reads_it() {
    compare_all(include_str!("expected_vti.tsv"));
}

#[test]
fn npy_reads_as_numpy_reads_it() {
    compare_all(include_str!("expected_npy.tsv"));
}
