//! What HDF5 files say beside grid and values, and what they are refused for.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::path::PathBuf;

use common::expected::unpack;
use common::table;
use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build, pyramid_path};
use volgraph_formats::{LoadOptions, is_volume, load};
use volgraph_volume::Volume;

const FILES: &str = include_str!("expected_hdf5.tsv");

fn one(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let rows = table(FILES);
    let row = rows.iter().find(|row| row["file"] == name).unwrap();
    let path = unpack(row, folder.path());
    (folder, path)
}

fn read(name: &str) -> Volume {
    let (_folder, path) = one(name);
    assert!(is_volume(&path));
    load(&path, &LoadOptions::default()).unwrap()
}

fn told(name: &str, part: Option<&str>) -> String {
    let (_folder, path) = one(name);
    let options = LoadOptions {
        part: part.map(str::to_owned),
        ..LoadOptions::default()
    };
    load(&path, &options).unwrap_err().to_string()
}

#[test]
fn formats_and_paths_are_told() {
    for (name, format, path) in [
        ("gzip_earliest.h5", "HDF5", "a/b"),
        ("itk.h5", "HDF5 (ITK)", "ITKImage/0/VoxelData"),
        ("netcdf.nc", "NetCDF-4", "speed"),
        ("xarray.nc", "NetCDF-4", "density"),
    ] {
        let volume = read(name);
        let about = volume.about();
        assert_eq!(about.format, format);
        let fact = ("dataset".to_owned(), path.to_owned());
        assert!(about.facts.contains(&fact), "{:?}", about.facts);
    }
    let netcdf = read("netcdf.nc");
    assert_eq!(netcdf.about().value_unit.as_deref(), Some("m/s"));
    let step = netcdf.about().step.clone().unwrap();
    assert_eq!(step.unit.as_deref(), Some("hours since 2000-01-01"));
}

#[test]
fn a_choice_is_listed() {
    let error = told("several.h5", None);
    assert!(
        error.contains("there are 3 arrays in this HDF5 file"),
        "{error}"
    );
    assert!(error.contains("pet") && error.contains("table"), "{error}");
    let error = told("several.h5", Some("mr"));
    assert!(error.contains("there is no part \"mr\""), "{error}");
}

#[test]
fn spacing_in_an_unknown_order_is_told() {
    let volume = read("unclear.h5");
    assert_eq!(volume.grid().spacing().to_array(), [1.0; 3]);
    let warning = volume.warnings().join(" ");
    assert!(warning.contains("spacing, origin"), "{warning}");
    let volume = read("uneven.nc");
    assert_eq!(volume.grid().spacing().to_array(), [1.0, 1.0, 5.0]);
    let warning = volume.warnings().join(" ");
    assert!(warning.contains("not evenly spaced"), "{warning}");
}

/// Arrays that lie in one run are left where they are, behind a user block too.
#[test]
fn bricks_are_read_of_plain_arrays() {
    for name in ["big_f4.h5", "little_u2.h5", "long_block.h5"] {
        let (_folder, path) = one(name);
        let volume = load(&path, &LoadOptions::default()).unwrap();
        build(&path, &pyramid_path(&path), &BuildOptions::default()).unwrap();
        let store = BrickStore::open(&path, &StoreOptions::default()).unwrap();
        let all = store.read_region(0, [0; 3], volume.grid().dims).unwrap();
        assert_eq!(&all, volume.voxels(), "{name}");
    }
    let (_folder, path) = one("gzip_earliest.h5");
    let error = build(&path, &pyramid_path(&path), &BuildOptions::default()).unwrap_err();
    assert!(error.to_string().contains("volgraph convert"), "{error}");
}

/// Some bytes of metadata are no reason to fill a GiB with the fill value.
#[test]
fn sizes_that_the_file_cannot_hold_are_refused() {
    let (_folder, path) = one("holes.h5");
    let mut bytes = std::fs::read(&path).unwrap();
    // The first axis of the shape, in the header's dataspace.
    let shape: Vec<u8> = [6_u64, 4, 5].iter().flat_map(|n| n.to_le_bytes()).collect();
    let at = bytes.windows(24).position(|part| part == shape).unwrap();
    for twice in [at, at + 24] {
        if bytes[twice..twice + 8] == 6_u64.to_le_bytes() {
            bytes[twice..twice + 8].copy_from_slice(&(1_u64 << 36).to_le_bytes());
        }
    }
    std::fs::write(&path, &bytes).unwrap();
    let error = load(&path, &LoadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "volume-too-large", "{error}");
    bytes[at..at + 8].copy_from_slice(&(1_u64 << 24).to_le_bytes());
    std::fs::write(&path, &bytes).unwrap();
    let error = load(&path, &LoadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "volume-data-too-short", "{error}");
}

#[test]
fn a_classic_netcdf_file_is_told_how_to_become_a_new_one() {
    let error = volgraph_formats::from_bytes("a.nc", b"CDF\x01\0\0\0\0", &LoadOptions::default());
    let error = error.unwrap_err();
    assert_eq!(error.code(), "volume-unsupported");
    assert!(error.trouble().remedy.contains("nccopy"), "{error}");
}
