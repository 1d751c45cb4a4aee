//! What NIfTI, VTI and NumPy files say beside grid and values.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::expected::unpack;
use common::table;
use volgraph_formats::{LoadOptions, load};
use volgraph_volume::{Component, Values, Volume};

const NIFTI: &str = include_str!("expected_nifti.tsv");
const VTI: &str = include_str!("expected_vti.tsv");
const NPY: &str = include_str!("expected_npy.tsv");

/// A small file of a table, with other bytes at some places.
fn read(
    text: &str,
    name: &str,
    changes: &[(usize, &[u8])],
    component: Option<Component>,
) -> Volume {
    let rows = table(text);
    let row = rows.iter().find(|row| row["file"] == name).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = unpack(row, folder.path());
    let mut bytes = std::fs::read(&path).unwrap();
    for (at, new) in changes {
        bytes[*at..at + new.len()].copy_from_slice(new);
    }
    std::fs::write(&path, bytes).unwrap();
    let options = LoadOptions {
        component,
        ..LoadOptions::default()
    };
    load(&path, &options).unwrap()
}

#[test]
fn nifti_says_what_its_values_mean() {
    let with = |intent: i16, name: &[u8]| {
        let changes: [(usize, &[u8]); 3] =
            [(68, &intent.to_le_bytes()), (328, name), (123, &[2 | 16])];
        read(NIFTI, "sform.nii", &changes, None)
    };
    let labels = with(1002, b"atlas\0");
    assert_eq!(
        labels.about().values,
        Values::Labels(std::collections::BTreeMap::new())
    );
    assert!(
        labels
            .about()
            .facts
            .contains(&("intent name".to_owned(), "atlas".to_owned()))
    );
    assert_eq!(labels.about().format, "NIfTI-1");
    assert_eq!(labels.about().length_unit.as_deref(), Some("mm"));
    assert_eq!(
        with(5, b"\0").about().values,
        Values::Named("z score".to_owned())
    );
    assert_eq!(
        with(5, b"zstat\x01\xff1\0").about().values,
        Values::Named("zstat1".to_owned())
    );
    assert_eq!(with(0, b"\0").about().values, Values::Unknown);
    assert_eq!(
        read(NIFTI, "two_big_float32.nii", &[], None).about().format,
        "NIfTI-2"
    );
}

#[test]
fn nifti_says_when_its_steps_are() {
    let volume = read(NIFTI, "series_3.nii", &[], None);
    let step = volume.about().step.as_ref().unwrap();
    assert_eq!((step.index, step.count, step.time), (0, 5, Some(10.0)));
    assert_eq!(step.unit.as_deref(), Some("s"));
}

#[test]
fn what_nibabel_mends_is_told() {
    for (name, says) in [
        ("pixdim_zero.nii", "pixdim[1] is 0; taken as 1"),
        ("pixdim_zero.nii", "pixdim[2] is -3; taken as 3"),
        ("qfac_zero.nii", "pixdim[0] is 0; taken as 1"),
        ("codes.nii", "qform_code is 77"),
        ("codes.nii", "sform_code is 99"),
        ("size_wrong.nii", "347 bytes"),
    ] {
        let volume = read(NIFTI, name, &[], None);
        let told = volume
            .warnings()
            .iter()
            .any(|warning| warning.contains(says));
        assert!(told, "{name}: {:?}", volume.warnings());
    }
    assert!(read(NIFTI, "sform.nii", &[], None).warnings().is_empty());
    // A single slice whose map has no third direction.
    let flat: [(usize, &[u8]); 4] = [
        (46, &[1, 0]),
        (288, &[0; 4]),
        (304, &[0; 4]),
        (320, &[0; 4]),
    ];
    let rows = table(NIFTI);
    let row = rows.iter().find(|row| row["file"] == "sform.nii").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = unpack(row, folder.path());
    let mut bytes = std::fs::read(&path).unwrap();
    for (at, new) in flat {
        bytes[at..at + new.len()].copy_from_slice(new);
    }
    bytes.truncate(352 + 12);
    std::fs::write(&path, bytes).unwrap();
    let volume = load(&path, &LoadOptions::default()).unwrap();
    assert!(
        volume.warnings()[0].contains("no third direction"),
        "{:?}",
        volume.warnings()
    );
}

#[test]
fn colours_are_drawn_as_they_are() {
    let nifti = read(NIFTI, "rgba.nii", &[], None);
    assert_eq!(nifti.colors().unwrap()[5], [5, 10, 15, 20]);
    assert!(read(VTI, "colors.vti", &[], None).colors().is_some());
    let npy = read(NPY, "colors.npy", &[], None);
    assert_eq!(npy.colors().unwrap()[1], [4, 5, 6, 7]);
    let lengths = read(NPY, "vectors.npy", &[], Some(Component::Magnitude));
    assert_eq!(
        lengths.voxel([1, 0, 0]),
        f64::from((9.0_f32 + 16.0 + 25.0).sqrt())
    );
}

#[test]
fn vti_says_where_its_values_lie() {
    let points = read(VTI, "extent.vti", &[], None);
    let cells = read(VTI, "cells.vti", &[], None);
    assert!(points.grid().node_centred && !cells.grid().node_centred);
    assert_eq!(points.about().values, Values::Named("density".to_owned()));
    assert!(
        cells
            .about()
            .facts
            .contains(&("values on".to_owned(), "cells".to_owned()))
    );
    // The box of points and that of the cells between them are the same.
    let rows = table(VTI);
    let row = rows.iter().find(|row| row["file"] == "cells.vti").unwrap();
    assert_eq!(row["dims"], "3 4 2");
    let corner = cells.grid().corners_world()[0];
    assert_eq!(corner.to_array(), [0.5, 2.5, 1.0]);
}

/// NetCDF marks cells without a value by a number that would spoil every histogram.
#[test]
fn cells_without_a_value_are_not_a_number() {
    use std::io::Read as _;
    let rows = common::table(include_str!("expected_hdf5.tsv"));
    let row = rows.iter().find(|row| row["file"] == "masked.nc").unwrap();
    let (_, packed) = row["bytes"].split_once(':').unwrap();
    let mut bytes = Vec::new();
    flate2::read::ZlibDecoder::new(common::unhex(packed).as_slice())
        .read_to_end(&mut bytes)
        .unwrap();
    let volume = volgraph_formats::from_bytes("masked.nc", &bytes, &LoadOptions::default());
    let volume = volume.unwrap();
    let none: Vec<bool> = (0..24).map(|i| volume.voxels().get(i).is_nan()).collect();
    assert_eq!(none.iter().filter(|none| **none).count(), 2);
    assert!(none[3] && none[23]);
    assert_eq!(volume.statistics().max, 22.0);
    assert_eq!(volume.about().format, "NetCDF-4");
    assert_eq!(volume.about().value_unit.as_deref(), Some("K"));
}
