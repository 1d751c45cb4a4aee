//! What is written is what was there: every writer, type and placement, read back bit for bit.
//!
//! With VOLGRAPH_WRITTEN set to a folder, the files stay there, with `written.tsv` of what must be in them, for
//! `check_written.py`, which reads them with other software.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{DAffine3, DMat3, DVec3, dvec3};
use volgraph_formats::{Compression, FileFormat, LoadOptions, WriteOptions, Written, load, write};
use volgraph_volume::edit::{Filter, Target, Watch, resample};
use volgraph_volume::{
    About, Component, Grid, ScalarType, Values, Volume, Voxels, for_scalar_type,
};

const DIMS: [u32; 3] = [7, 5, 3];

fn samples(ty: ScalarType) -> Voxels {
    for_scalar_type!(ty, T => {
        let at = |i: u32| match i {
            0 => T::MIN,
            1 => T::MAX,
            i => ((i * 37 + 11) % 120) as T,
        };
        (0..105).map(at).collect::<Vec<T>>().into()
    })
}

/// Named placements: along the axes, turned, mirrored, sheared.
fn placements() -> [(&'static str, Grid); 4] {
    let turn = DMat3::from_axis_angle(dvec3(1.0, 2.0, 3.0).normalize(), 0.7);
    let scale = DMat3::from_diagonal(dvec3(0.5, 1.25, 3.0));
    let place = |matrix3| Grid {
        dims: DIMS,
        world_from_index: DAffine3 {
            matrix3,
            translation: dvec3(-10.1, 20.2, 1e3 / 3.0),
        },
        node_centred: false,
    };
    let mirror = DMat3::from_diagonal(dvec3(1.0, 1.0, -1.0));
    let shear = DMat3::from_cols(DVec3::X, dvec3(0.25, 1.0, 0.0), DVec3::Z);
    [
        ("plain", place(scale)),
        ("turned", place(turn * scale)),
        ("mirrored", place(turn * mirror * scale)),
        ("sheared", place(turn * shear * scale)),
    ]
}

fn put(volume: &Volume, path: &Path) -> Written {
    write(volume, path, &WriteOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn read(path: &Path) -> Volume {
    load(path, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn close(a: &Grid, b: &Grid, tolerance: f64) -> bool {
    let pairs = a
        .world_from_index
        .to_cols_array()
        .into_iter()
        .zip(b.world_from_index.to_cols_array());
    a.dims == b.dims && pairs.into_iter().all(|(a, b)| (a - b).abs() <= tolerance)
}

#[test]
fn every_type_and_placement_comes_back() {
    let temporary = tempfile::tempdir().unwrap();
    let kept = std::env::var_os("VOLGRAPH_WRITTEN").map(PathBuf::from);
    let folder = kept.as_deref().unwrap_or(temporary.path());
    let mut list = String::from("file\ttype\taffine\tdata\n");
    for ty in ScalarType::ALL {
        for (name, grid) in placements() {
            // The placement is the same for all types: two of them have all the placements.
            if name != "plain" && !matches!(ty, ScalarType::U8 | ScalarType::F64) {
                continue;
            }
            let volume = Volume::new("v", grid, samples(ty)).unwrap();
            let stem = format!("{name}_{ty}");
            for ending in [
                ".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", "_2.nii", ".npy", ".zarr",
            ] {
                let path = folder.join(format!("{}{stem}{ending}", ending.replace('.', "")));
                let options = WriteOptions {
                    format: (ending == "_2.nii").then_some(FileFormat::Nifti2),
                    ..WriteOptions::default()
                };
                write(&volume, &path, &options).unwrap();
                let affine = grid
                    .world_from_index
                    .to_cols_array()
                    .map(|value| value.to_string())
                    .join(" ");
                let data: String = volume
                    .voxels()
                    .as_bytes()
                    .iter()
                    .map(|byte| format!("{byte:02x}"))
                    .collect();
                let file = path.file_name().unwrap().to_string_lossy();
                writeln!(list, "{file}\t{ty}\t{affine}\t{data}").unwrap();
                let back = load(&path, &LoadOptions::default()).unwrap();
                assert_eq!(back.voxels(), volume.voxels(), "{path:?}");
                let tolerance = match ending {
                    // Directions and spacing apart: their product may differ in the last digit.
                    ".mha" | ".mhd" => 1e-15,
                    // float32.
                    ".nii" | ".nii.gz" => 2e-5,
                    // No placement at all.
                    ".npy" => f64::INFINITY,
                    _ => 0.0,
                };
                assert!(
                    close(back.grid(), &grid, tolerance),
                    "{path:?}: {:?}",
                    back.grid()
                );
            }
            let path = folder.join(format!("{name}_7x5x3_{ty}.raw"));
            put(&volume, &path);
            assert_eq!(read(&path).voxels(), volume.voxels());
        }
    }
    if kept.is_some() {
        fs::write(folder.join("written.tsv"), list).unwrap();
    }
}

fn volume() -> Volume {
    let [_, (_, grid), ..] = placements();
    Volume::new("v", grid, samples(ScalarType::I16)).unwrap()
}

#[test]
fn packed_files_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let volume = volume();
    for (name, compression) in [
        ("a.nrrd", Compression::Gzip(9)),
        ("a.nhdr", Compression::Gzip(1)),
        ("a.mha", Compression::Gzip(6)),
        ("a.mhd", Compression::Gzip(6)),
        ("a_7x5x3_int16.raw.gz", Compression::Gzip(6)),
        ("none.zarr", Compression::None),
        ("gzip.zarr", Compression::Gzip(5)),
        ("zstd.zarr", Compression::Zstd(7)),
    ] {
        let options = WriteOptions {
            compression: Some(compression),
            chunk: [4, 2, 2],
            ..WriteOptions::default()
        };
        let path = folder.path().join(name);
        let written = write(&volume, &path, &options).unwrap();
        assert_eq!(written.files[0], path);
        assert!(written.bytes > 0);
        assert_eq!(read(&path).voxels(), volume.voxels(), "{name}");
    }
    let leftover = fs::read_dir(folder.path()).unwrap().filter(|entry| {
        entry
            .as_ref()
            .unwrap()
            .file_name()
            .to_string_lossy()
            .starts_with('.')
    });
    assert_eq!(leftover.count(), 0);
}

#[test]
fn a_pyramid_has_the_levels_that_resampling_makes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.zarr");
    let volume = volume();
    let options = WriteOptions {
        levels: WriteOptions::ALL_LEVELS,
        chunk: [3, 3, 3],
        ..WriteOptions::default()
    };
    write(&volume, &path, &options).unwrap();
    let mut want = volume;
    let mut level = 0;
    loop {
        let options = LoadOptions {
            level: Some(level),
            ..LoadOptions::default()
        };
        let back = load(&path, &options).unwrap();
        assert_eq!(back.digest(), want.digest(), "level {level}");
        let dims = want.grid().dims;
        if dims.iter().all(|&n| n <= 3) {
            break;
        }
        let dims = dims.map(|n| n.div_ceil(2));
        want = resample(&want, Target::Dims(dims), Filter::Linear, &Watch::default()).unwrap();
        level += 1;
    }
    assert_eq!(level, 2);
}

#[test]
fn colours_labels_units_and_nodes_are_kept_where_they_can_be() {
    let folder = tempfile::tempdir().unwrap();
    let names = [(1, "one".to_owned()), (7, "sieben".to_owned())].into();
    let mut grid = placements()[1].1;
    grid.node_centred = true;
    let colors: Vec<[u8; 4]> = (0..105).map(|i| [i, 255 - i, 7, 200 - i]).collect();
    let about = About {
        length_unit: Some("mm".to_owned()),
        values: Values::Labels(names),
        ..About::default()
    };
    let labels = Volume::new("v", grid, samples(ScalarType::U8))
        .unwrap()
        .with_about(about.clone());
    for ending in ["nrrd", "zarr"] {
        let path = folder.path().join(format!("labels.{ending}"));
        put(&labels, &path);
        let back = read(&path);
        assert_eq!(back.digest(), labels.digest(), "{ending}");
        assert_eq!(back.about().values, about.values, "{ending}");
        assert_eq!(back.about().length_unit, about.length_unit, "{ending}");
    }
    for ending in ["mha", "nii", "npy"] {
        let written = put(&labels, &folder.path().join(format!("labels.{ending}")));
        assert!(
            written.warnings.iter().any(|text| text.contains("nodes")),
            "{ending}"
        );
    }
    let colored = Volume::new("v", grid, samples(ScalarType::U8))
        .unwrap()
        .with_colors(colors.clone())
        .unwrap();
    for ending in ["nrrd", "mha", "zarr"] {
        let path = folder.path().join(format!("colors.{ending}"));
        put(&colored, &path);
        let options = LoadOptions {
            component: Some(Component::Color),
            ..LoadOptions::default()
        };
        assert_eq!(
            load(&path, &options).unwrap().colors().unwrap(),
            colors,
            "{ending}"
        );
    }
    let raw = put(&colored, &folder.path().join("c_7x5x3_uint8.raw"));
    assert!(raw.warnings.iter().any(|text| text.contains("colours")));
}

#[test]
fn nothing_is_written_over_or_left_behind() {
    let folder = tempfile::tempdir().unwrap();
    let volume = volume();
    let over = WriteOptions {
        overwrite: true,
        ..WriteOptions::default()
    };
    for name in ["a.nrrd", "a.nhdr", "b.mhd", "a.zarr"] {
        let path = folder.path().join(name);
        put(&volume, &path);
        let error = write(&volume, &path, &WriteOptions::default()).unwrap_err();
        assert_eq!(error.code(), "volume-write", "{name}");
        assert!(error.to_string().contains(name));
        write(&volume, &path, &over).unwrap();
        assert_eq!(read(&path).voxels(), volume.voxels());
    }
    // A folder that is no Zarr one stays, whatever is asked for.
    let mine = folder.path().join("mine.zarr");
    fs::create_dir(&mine).unwrap();
    fs::write(mine.join("thesis.txt"), "years").unwrap();
    assert_eq!(
        write(&volume, &mine, &over).unwrap_err().code(),
        "volume-write"
    );
    assert!(mine.join("thesis.txt").is_file());
    // The data file of a detached header is somebody's, too.
    fs::write(folder.path().join("c.raw"), "mine").unwrap();
    let error = write(
        &volume,
        &folder.path().join("c.nhdr"),
        &WriteOptions::default(),
    )
    .unwrap_err();
    assert_eq!(error.code(), "volume-write");

    let before = fs::read_dir(folder.path()).unwrap().count();
    for name in [
        "i.nrrd",
        "i.nhdr",
        "i.mha",
        "i.nii.gz",
        "i.npy",
        "i_7x5x3_int16.raw",
        "i.zarr",
    ] {
        let stop = Arc::new(AtomicBool::new(false));
        let on_progress = stop.clone();
        let options = WriteOptions {
            chunk: [2; 3],
            watch: Watch {
                // From the first block on.
                progress: Some(Arc::new(move |_, _| {
                    on_progress.store(true, Ordering::Relaxed);
                })),
                interrupt: Some(stop),
            },
            ..WriteOptions::default()
        };
        let error = write(&volume, &folder.path().join(name), &options).unwrap_err();
        assert_eq!(error.code(), "volume-interrupted", "{name}");
        assert!(error.to_string().contains(name));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before);
}

#[test]
fn progress_ends_with_all_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.nrrd", "a.zarr"] {
        let last = Arc::new(AtomicU64::new(0));
        let seen = last.clone();
        let options = WriteOptions {
            watch: Watch {
                progress: Some(Arc::new(move |done, total| {
                    assert_eq!(total, 210);
                    seen.fetch_max(done, Ordering::Relaxed);
                })),
                interrupt: None,
            },
            ..WriteOptions::default()
        };
        write(&volume(), &folder.path().join(name), &options).unwrap();
        assert_eq!(last.load(Ordering::Relaxed), 210);
    }
}

#[test]
fn names_and_options_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let with = |name: &str, compression: Option<Compression>| {
        let options = WriteOptions {
            compression,
            ..WriteOptions::default()
        };
        let error = write(&volume(), &folder.path().join(name), &options).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        error
    };
    for (name, compression, code) in [
        ("a.png", None, "volume-write"),
        ("a.raw", None, "volume-raw-name"),
        ("a_7x5x4_int16.raw", None, "volume-raw-name"),
        ("a_7x5x3_uint16.raw", None, "volume-raw-name"),
        ("a_7x5x3_int16_be.raw", None, "volume-raw-name"),
        (
            "a_7x5x3_int16.raw",
            Some(Compression::Gzip(6)),
            "volume-raw-name",
        ),
        ("a.nii", Some(Compression::Gzip(6)), "volume-write"),
        ("a.nii.gz", Some(Compression::None), "volume-write"),
        ("a.npy", Some(Compression::Gzip(6)), "volume-write"),
        ("a.nrrd", Some(Compression::Gzip(10)), "volume-write"),
        ("a.nrrd", Some(Compression::Zstd(3)), "volume-write"),
        ("a.zarr", Some(Compression::Zstd(0)), "volume-write"),
        ("nowhere/a.nrrd", None, "volume-write"),
    ] {
        assert_eq!(with(name, compression).code(), code, "{name}");
    }
    let remedy = with("a.raw", None).trouble().remedy.clone();
    assert_eq!(remedy, "name it v_7x5x3_int16.raw");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
