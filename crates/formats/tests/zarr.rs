//! Zarr folders by zarr-python (`make_zarr.py`), and what is broken on purpose.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use common::{numbers, table, unhex};
use volgraph_formats::zarr::Pyramid;
use volgraph_formats::{LoadOptions, VolumeReader, load};
use volgraph_volume::{Component, Values, Volume, VolumeError, Voxels};

/// Writes the folders of one case, or of all.
fn unpack(folder: &Path, case: Option<&str>) {
    for row in table(include_str!("zarr_files.tsv")) {
        if case.is_none_or(|case| case == row["case"]) {
            let path = folder.join(row["case"]).join(row["path"]);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, unhex(row["hex"])).unwrap();
        }
    }
}

fn one(case: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    unpack(folder.path(), Some(case));
    let path = folder.path().join(case);
    (folder, path)
}

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
            let good = error.to_string().contains(row["case"]) && !error.trouble().remedy.is_empty();
            return if good { Ok(()) } else { Err(format!("names no file or remedy: {error}")) };
        }
        (Err(error), code) => return Err(format!("expected {code}, got [{}] {error}", error.code())),
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
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("; ")) }
}

#[test]
fn folders_read_as_zarr_python_reads_them() {
    let folder = tempfile::tempdir().unwrap();
    unpack(folder.path(), None);
    let rows = table(include_str!("expected_zarr.tsv"));
    assert!(rows.len() > 60);
    let failed: Vec<String> = rows
        .iter()
        .filter_map(|row| Some(format!("{}: {}", row["case"], compare(row, folder.path()).err()?)))
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
        assert_eq!((about.format.as_str(), about.length_unit.as_deref()), (format, Some("µm")));
        let step = about.step.as_ref().unwrap();
        assert_eq!((step.time, step.unit.as_deref()), (Some(1.0), Some("s")));
        assert!(about.facts.contains(&("channel 1".to_owned(), "actin 00FF00".to_owned())));
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
        let file = if format.ends_with('5') { "zarr.json" } else { ".zattrs" };
        assert_eq!(load(&path.join(file), &options).unwrap().grid(), volume.grid());
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
        LoadOptions { time: Some(1), ..options.clone() },
        LoadOptions { level: Some(1), ..options.clone() },
        LoadOptions { component: Some(Component::Index(0)), ..options.clone() },
    ] {
        assert_eq!(load(&path, &other).unwrap_err().code(), "volume-data-corrupt");
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
    for case in ["v3_sharded", "v3_transposed", "v2_zlib", "v3_holes", "named", "five_axes", "ome_0_5"] {
        let (_folder, path) = one(case);
        let options = LoadOptions {
            component: Some(Component::Index(if case == "five_axes" { 4 } else { 0 })),
            ..LoadOptions::default()
        };
        let pyramid = Pyramid::open(&path, &options).unwrap();
        for number in 0..pyramid.levels().len() {
            let whole = load(&path, &LoadOptions { level: Some(number as u32), ..options.clone() }).unwrap();
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
                assert_eq!(region, cut(&whole, origin, size), "{case} {origin:?} {size:?}");
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
        assert_eq!(pyramid.read_region(9, [0; 3], [1; 3]).unwrap_err().code(), "volume-option");
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

/// The outcome with one file's text changed.
fn forged(case: &str, file: &str, change: impl Fn(String) -> String) -> Result<Volume, VolumeError> {
    let (_folder, path) = one(case);
    let file = path.join(file);
    let old = fs::read_to_string(&file).unwrap();
    let new = change(old.clone());
    assert_ne!(old, new, "{case}");
    fs::write(&file, new).unwrap();
    load(&path, &LoadOptions { component: Some(Component::Index(0)), ..LoadOptions::default() })
}

/// JSON with one value replaced.
fn set(text: &str, pointer: &str, value: serde_json::Value) -> String {
    let mut json: serde_json::Value = serde_json::from_str(text).unwrap();
    *json.pointer_mut(pointer).unwrap() = value;
    json.to_string()
}

#[test]
fn forged_metadata_is_refused_with_a_reason() {
    use serde_json::json;
    let huge = 1_u64 << 40;
    for (case, file, pointer, value, code) in [
        ("v3_int16", "zarr.json", "/shape", json!([huge, huge, huge]), "volume-too-large"),
        ("v3_int16", "zarr.json", "/shape", json!([0, 6, 7]), "volume-grid"),
        ("v3_int16", "zarr.json", "/shape", json!([1 << 20, 1 << 20, 1]), "volume-too-large"),
        ("v3_int16", "zarr.json", "/chunk_grid/configuration/chunk_shape", json!([huge, huge, huge]), "volume-too-large"),
        ("v3_int16", "zarr.json", "/chunk_grid/configuration/chunk_shape", json!([1 << 20, 64, 3]), "volume-data-corrupt"),
        ("v3_int16", "zarr.json", "/chunk_grid/configuration/chunk_shape", json!([0, 1, 1]), "volume-bad-value"),
        ("v3_int16", "zarr.json", "/chunk_grid/configuration/chunk_shape", json!([1, 1]), "volume-bad-value"),
        ("v3_int16", "zarr.json", "/chunk_grid/name", json!("rectilinear"), "volume-unsupported"),
        ("v3_int16", "zarr.json", "/data_type", json!("int24"), "volume-unknown-type"),
        ("v3_int16", "zarr.json", "/fill_value", json!(70000), "volume-bad-value"),
        ("v3_int16", "zarr.json", "/codecs/0/name", json!("packbits"), "volume-unsupported"),
        ("v3_int16", "zarr.json", "/codecs", json!([]), "volume-unsupported"),
        ("v3_int16", "zarr.json", "/codecs/1/name", json!("gzip"), "volume-data-corrupt"),
        ("v3_transposed", "zarr.json", "/codecs/0/configuration/order", json!([0, 0, 1]), "volume-bad-value"),
        ("v3_sharded", "zarr.json", "/codecs/0/configuration/chunk_shape", json!([3, 4, 3]), "volume-bad-value"),
        ("v3_sharded", "zarr.json", "/codecs/0/configuration/chunk_shape", json!([1, 1, 1]), "volume-data-corrupt"),
        ("v2_zstd", ".zarray", "/filters", json!([{"id": "delta"}]), "volume-unsupported"),
        ("v2_zstd", ".zarray", "/dtype", json!("<c8"), "volume-unknown-type"),
        ("v2_zstd", ".zarray", "/dtype", json!("é"), "volume-unknown-type"),
        ("v2_zstd", ".zarray", "/compressor/id", json!("lzma"), "volume-unsupported"),
        ("ome_0_5", "zarr.json", "/attributes/ome/multiscales/0/datasets/0/path", json!("../0"), "volume-bad-value"),
        ("ome_0_5", "zarr.json", "/attributes/ome/multiscales/0/datasets/0/path", json!("9"), "volume-data-file"),
        ("ome_0_5", "zarr.json", "/attributes/ome/multiscales/0/datasets", json!([]), "volume-bad-value"),
        ("ome_0_5", "zarr.json", "/attributes/ome/multiscales/0/axes", json!(["z", "y", "x"]), "volume-bad-value"),
        ("ome_0_5", "zarr.json", "/attributes/ome/multiscales/0/coordinateTransformations/0/scale", json!([1, 1, 0, 1, 1]), "volume-grid"),
        ("ome_0_5", "zarr.json", "/attributes/ome/multiscales/0/coordinateTransformations/0/type", json!("affine"), "volume-unsupported"),
    ] {
        let error = forged(case, file, |text| set(&text, pointer, value.clone())).unwrap_err();
        assert_eq!(error.code(), code, "{case} {pointer} {value}: {error}");
        assert!(error.to_string().contains(case) && !error.trouble().remedy.is_empty());
    }
    let error = forged("v3_int16", "zarr.json", |text| text[..text.len() / 2].to_owned()).unwrap_err();
    assert_eq!(error.code(), "volume-header-syntax");
    let deep = forged("v3_int16", "zarr.json", |_| "[".repeat(100_000)).unwrap_err();
    assert_eq!(deep.code(), "volume-header-syntax");
}

#[test]
fn a_stream_that_makes_more_of_itself_is_stopped() {
    let zeros = vec![0_u8; 1 << 26];
    for (case, file, bomb) in [
        ("v2_gzip", "0.0.0", common::gzip(&zeros)),
        ("v2_zstd", "0.0.0", zstd::bulk::compress(&zeros, 3).unwrap()),
        // A header that promises 2^60 bytes in one segment.
        ("v2_zstd", "0.0.0", [&b"\x28\xb5\x2f\xfd\xe0"[..], &(1_u64 << 60).to_le_bytes(), b"\x01\0\0"].concat()),
        ("v2_blosc_lz4_1", "0.0.0", [&b"\x02\x01\x21\x04"[..], &[0xff; 8], &16_u32.to_le_bytes()].concat()),
    ] {
        let (_folder, path) = one(case);
        assert!(path.join(file).is_file(), "{case}");
        fs::write(path.join(file), bomb).unwrap();
        let error = load(&path, &LoadOptions::default()).unwrap_err();
        assert_eq!(error.code(), "volume-data-corrupt", "{case}: {error}");
    }
}

#[test]
fn too_many_chunks_are_refused_before_they_are_looked_for() {
    let error = forged("v3_holes", "zarr.json", |text| {
        let text = set(&text, "/shape", serde_json::json!([1000, 1000, 1000]));
        set(&text, "/chunk_grid/configuration/chunk_shape", serde_json::json!([1, 1, 1]))
    });
    assert_eq!(error.unwrap_err().code(), "volume-too-large");
}

/// Numbers for changes, the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

#[test]
fn mutants_are_read_or_refused_and_never_panic() {
    let nasty = ["0", "-1", "1e999", "18446744073709551615", "4294967296", "null", "\"\"", "[]", "1000000"];
    let mut random = Random(88_172_645_463_325_252);
    let cases: Vec<&str> = {
        let mut cases: Vec<&str> = table(include_str!("zarr_files.tsv")).iter().map(|row| row["case"]).collect();
        cases.dedup();
        cases
    };
    let (mut read, mut refused) = (0, 0);
    for case in cases {
        let (_folder, path) = one(case);
        let rows = table(include_str!("zarr_files.tsv"));
        let files: Vec<_> = rows.iter().filter(|row| row["case"] == case).collect();
        for _ in 0..60 {
            let row = files[random.below(files.len())];
            let good = unhex(row["hex"]);
            let mut bytes = good.clone();
            for _ in 0..=random.below(3) {
                let at = random.below(bytes.len());
                match random.below(4) {
                    0 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
                    1 => bytes.truncate(at),
                    2 if !bytes.is_empty() => bytes[at] = random.below(256) as u8,
                    _ => {
                        let starts: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
                        if let Some(&start) = starts.get(random.below(starts.len())) {
                            bytes.splice(start..=start, nasty[random.below(nasty.len())].bytes());
                        }
                    }
                }
            }
            fs::write(path.join(row["path"]), &bytes).unwrap();
            let options = LoadOptions {
                component: (random.below(3) > 0).then_some(Component::Index(0)),
                max_bytes: Some(1 << 20),
                ..LoadOptions::default()
            };
            match load(&path, &options) {
                Ok(volume) => {
                    assert_eq!(volume.voxels().len() as u64, volume.grid().voxel_count());
                    read += 1;
                }
                Err(error) => {
                    assert!(error.to_string().contains(case), "{error}");
                    assert!(!error.trouble().remedy.is_empty());
                    refused += 1;
                }
            }
            fs::write(path.join(row["path"]), good).unwrap();
        }
    }
    assert!(read > 200 && refused > 200, "{read} {refused}");
}
