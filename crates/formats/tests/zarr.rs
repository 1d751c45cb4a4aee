//! Zarr folders by zarr-python (`make_zarr.py`), whole and in parts.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use common::zarr::{one, unpack};
use common::{numbers, table};
use volgraph_formats::zarr::Pyramid;
use volgraph_formats::{LoadOptions, VolumeReader, load};
use volgraph_volume::{Component, Values, Volume, Voxels};

fn compare(row: &HashMap<&str, &str>, folder: &Path) -> Result<(), String> {
    let options = LoadOptions {
        part: Some(row["part"].to_owned()).filter(|part| !part.is_empty()),
        level: row["level"].parse().ok(),
        component: row["component"].parse().ok(),
        time: row["time"].parse().ok(),
        ..LoadOptions::default()
    };
    let volume = match (load(&folder.join(row["case"]), &options), row["outcome"]) {
        (Ok(volume), "ok") => volume,
        (Ok(_), code) => return Err(format!("read, but expected {code}")),
        (Err(error), code) if error.code() == code => {
            let good =
                error.to_string().contains(row["case"]) && !error.trouble().remedy.is_empty();
            return if good {
                Ok(())
            } else {
                Err(format!("names no file or remedy: {error}"))
            };
        }
        (Err(error), code) => {
            return Err(format!("expected {code}, got [{}] {error}", error.code()));
        }
    };
    let (grid, statistics) = (volume.grid(), volume.statistics());
    let mut wrong = Vec::new();
    let mut check = |what: &str, got: &[f64], want: &str, tolerance: f64| {
        let want: Vec<f64> = numbers(want);
        let close = |(a, b): (&f64, &f64)| (a - b).abs() <= tolerance * b.abs().max(1.0);
        if got.len() != want.len() || !got.iter().zip(&want).all(close) {
            wrong.push(format!("{what} is {got:?}, not {want:?}"));
        }
    };
    check("dims", &grid.dims.map(f64::from), row["dims"], 0.0);
    let columns = grid.world_from_index.matrix3.to_cols_array();
    check("columns", &columns, row["columns"], 1e-13);
    check("origin", &grid.origin().to_array(), row["origin"], 1e-13);
    check("min", &[statistics.min], row["min"], 0.0);
    check("max", &[statistics.max], row["max"], 0.0);
    check("mean", &[statistics.mean], row["mean"], 1e-12);
    let (mut sum, mut i) = (0.0, 0_u32);
    volume.voxels().for_each(|value| {
        sum += value * f64::from(i % 1009);
        i += 1;
    });
    check("weighted", &[sum / f64::from(i)], row["weighted"], 1e-12);
    if volume.voxels().scalar_type().name() != row["type"] {
        wrong.push(format!("type is {}", volume.voxels().scalar_type()));
    }
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(wrong.join("; "))
    }
}

#[test]
fn folders_read_as_zarr_python_reads_them() {
    let folder = tempfile::tempdir().unwrap();
    unpack(folder.path(), None);
    let rows = table(include_str!("expected_zarr.tsv"));
    assert!(rows.len() > 60);
    let failed: Vec<String> = rows
        .iter()
        .filter_map(|row| {
            Some(format!(
                "{}: {}",
                row["case"],
                compare(row, folder.path()).err()?
            ))
        })
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));

    // The comparison sees each kind of difference.
    let good = rows.iter().find(|row| row["case"] == "ome_0_5").unwrap();
    for (column, other) in [
        ("type", "int16"),
        ("dims", "10 8 7"),
        ("columns", "0.75 0 0 0 1.5 0 0 0 6.1"),
        ("origin", "0 0 30.001"),
        ("max", "1"),
        ("mean", "1"),
        ("weighted", "1"),
        ("outcome", "volume-grid"),
        ("time", "2"),
        ("component", "0"),
        ("level", "1"),
        ("part", "nuclei"),
    ] {
        let mut row = good.clone();
        row.insert(column, other);
        assert!(compare(&row, folder.path()).is_err(), "{column}");
    }
}

#[test]
fn ome_says_units_times_channels_and_labels() {
    for (case, format) in [("ome_0_4", "OME-Zarr 0.4"), ("ome_0_5", "OME-Zarr 0.5")] {
        let (_folder, path) = one(case);
        let options = LoadOptions {
            component: Some(Component::Index(0)),
            ..LoadOptions::default()
        };
        let reader = VolumeReader::open(&path, &options).unwrap();
        assert_eq!(reader.step_count(), 3);
        let volume = reader.read(Some(2)).unwrap();
        let about = volume.about();
        assert_eq!(
            (about.format.as_str(), about.length_unit.as_deref()),
            (format, Some("µm"))
        );
        let step = about.step.as_ref().unwrap();
        assert_eq!((step.time, step.unit.as_deref()), (Some(1.0), Some("s")));
        assert!(
            about
                .facts
                .contains(&("channel 1".to_owned(), "actin 00FF00".to_owned()))
        );
        assert_eq!(volume.name(), "cells");
        let labels = LoadOptions {
            part: Some("nuclei".to_owned()),
            ..LoadOptions::default()
        };
        let labels = load(&path, &labels).unwrap();
        let Values::Labels(names) = &labels.about().values else {
            panic!("{:?}", labels.about())
        };
        assert_eq!(names.get(&7).map(String::as_str), Some("seven"));
        // A metadata file means its folder.
        let file = if format.ends_with('5') {
            "zarr.json"
        } else {
            ".zattrs"
        };
        assert_eq!(
            load(&path.join(file), &options).unwrap().grid(),
            volume.grid()
        );
    }
}

#[test]
fn chunks_of_other_steps_levels_and_components_are_not_read() {
    let (_folder, path) = one("ome_0_5");
    let options = LoadOptions {
        component: Some(Component::Index(1)),
        time: Some(2),
        ..LoadOptions::default()
    };
    let good = load(&path, &options).unwrap();
    // Of level 0 every chunk but those of step 2, channel 1.
    for level in ["0", "1"] {
        for (t, c) in (0..3).flat_map(|t| (0..2).map(move |c| (t, c))) {
            if (level, t, c) != ("0", 2, 1) {
                spoil(&path.join(format!("{level}/c/{t}/{c}")));
            }
        }
    }
    assert_eq!(load(&path, &options).unwrap().digest(), good.digest());
    for other in [
        LoadOptions {
            time: Some(1),
            ..options.clone()
        },
        LoadOptions {
            level: Some(1),
            ..options.clone()
        },
        LoadOptions {
            component: Some(Component::Index(0)),
            ..options.clone()
        },
    ] {
        assert_eq!(
            load(&path, &other).unwrap_err().code(),
            "volume-data-corrupt"
        );
    }
}

/// Writes nonsense into all files below.
fn spoil(path: &Path) {
    if path.is_dir() {
        for entry in fs::read_dir(path).unwrap() {
            spoil(&entry.unwrap().path());
        }
    } else {
        fs::write(path, b"nonsense").unwrap();
    }
}

/// The voxels of a box of a volume.
fn cut(volume: &Volume, origin: [u32; 3], size: [u32; 3]) -> Voxels {
    let part = volgraph_volume::edit::crop(volume, origin, size, &Default::default()).unwrap();
    part.voxels().clone()
}

#[test]
fn regions_are_parts_of_the_whole() {
    for case in [
        "v3_sharded",
        "v3_transposed",
        "v2_zlib",
        "v3_holes",
        "named",
        "five_axes",
        "ome_0_5",
    ] {
        let (_folder, path) = one(case);
        let options = LoadOptions {
            component: Some(Component::Index(if case == "five_axes" { 4 } else { 0 })),
            ..LoadOptions::default()
        };
        let pyramid = Pyramid::open(&path, &options).unwrap();
        for number in 0..pyramid.levels().len() {
            let whole = load(
                &path,
                &LoadOptions {
                    level: Some(number as u32),
                    ..options.clone()
                },
            )
            .unwrap();
            let level = pyramid.levels().nth(number).unwrap();
            assert_eq!(&level.grid, whole.grid(), "{case}");
            assert_eq!(level.scalar_type, whole.voxels().scalar_type());
            let [nx, ny, nz] = level.grid.dims;
            for (origin, size) in [
                ([0, 0, 0], [nx, ny, nz]),
                ([nx - 1, ny - 1, nz - 1], [1, 1, 1]),
                ([1, 2, 1], [2, 1, nz - 1]),
                ([2, 0, 2], [nx - 2, ny, 1]),
            ] {
                let region = pyramid.read_region(number, origin, size).unwrap();
                assert_eq!(
                    region,
                    cut(&whole, origin, size),
                    "{case} {origin:?} {size:?}"
                );
            }
            for (origin, size) in [
                ([0, 0, 0], [nx + 1, 1, 1]),
                ([nx, 0, 0], [1, 1, 1]),
                ([0, 0, 0], [0, 1, 1]),
                ([u32::MAX, 0, 0], [u32::MAX, 1, 1]),
            ] {
                let error = pyramid.read_region(number, origin, size).unwrap_err();
                assert_eq!(error.code(), "volume-option");
            }
        }
        assert_eq!(
            pyramid.read_region(9, [0; 3], [1; 3]).unwrap_err().code(),
            "volume-option"
        );
    }
}

#[test]
fn a_region_reads_the_inner_chunks_it_needs_alone() {
    let (_folder, path) = one("v3_sharded");
    let pyramid = Pyramid::open(&path, &LoadOptions::default()).unwrap();
    assert_eq!(pyramid.levels().next().unwrap().chunk, [3, 4, 2]);
    let before = pyramid.read_region(0, [0; 3], [3, 4, 2]).unwrap();
    // The first inner chunk stands first in its shard: what follows up to the index may be anything.
    let shard = path.join("c/0/0/0");
    let mut bytes = fs::read(&shard).unwrap();
    let entry = bytes.len() - 4 - 8 * 16;
    let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    let (offset, size) = (number(entry), number(entry + 8));
    let mut spoiled: Vec<u8> = vec![0; entry];
    spoiled[offset..offset + size].copy_from_slice(&bytes[offset..offset + size]);
    bytes[..entry].copy_from_slice(&spoiled);
    fs::write(&shard, bytes).unwrap();
    assert_eq!(pyramid.read_region(0, [0; 3], [3, 4, 2]).unwrap(), before);
    let error = pyramid.read_region(0, [0; 3], [4, 4, 2]).unwrap_err();
    assert_eq!(error.code(), "volume-data-corrupt");
    assert!(error.to_string().contains("c/0/0/0"));
}

/// The chunks of a shard are read from one open file by many threads.
#[test]
fn chunks_of_a_shard_do_not_mix() {
    let folder = tempfile::tempdir().unwrap();
    let metadata = serde_json::json!({
        "zarr_format": 3, "node_type": "array", "shape": [256, 32, 32], "data_type": "uint8", "fill_value": 0,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [256, 32, 32]}},
        "chunk_key_encoding": {"name": "default"},
        "codecs": [{"name": "sharding_indexed", "configuration": {
            "chunk_shape": [1, 32, 32], "codecs": [{"name": "bytes"}],
            "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]}}],
    });
    let path = folder.path();
    fs::write(path.join("zarr.json"), metadata.to_string()).unwrap();
    let mut shard: Vec<u8> = (0..=255).flat_map(|slice: u8| [slice; 1024]).collect();
    let index = (0..256_u64).flat_map(|slice| [1024 * slice, 1024]);
    shard.extend(index.flat_map(u64::to_le_bytes));
    fs::create_dir_all(path.join("c/0/0")).unwrap();
    fs::write(path.join("c/0/0/0"), &shard).unwrap();
    for _ in 0..50 {
        let volume = load(path, &LoadOptions::default()).unwrap();
        assert_eq!(volume.voxels().as_bytes(), &shard[..256 << 10]);
    }
}
