//! Files by other software, against what pynrrd and SimpleITK read from them (`make_expected.py`).
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::collections::HashMap;
use std::path::Path;

use common::{data_folder, numbers, table, unhex};
use volgraph_formats::{LoadOptions, load};

/// What is wrong with the outcome of a row; empty where nothing is.
fn compare(row: &HashMap<&str, &str>, path: &Path) -> Result<(), String> {
    let options = LoadOptions {
        component: row["component"].parse().ok(),
        ..LoadOptions::default()
    };
    let volume = match (load(path, &options), row["outcome"]) {
        (Ok(volume), "ok") => volume,
        (Ok(_), code) => return Err(format!("read, but expected {code}")),
        (Err(error), code) if error.code() == code => {
            let file = path.file_name().unwrap().to_string_lossy();
            let stem = file
                .split('.')
                .next()
                .unwrap()
                .split("_byteskip")
                .next()
                .unwrap();
            let named = error
                .to_string()
                .contains(stem.split("_nifti").next().unwrap());
            return if named {
                Ok(())
            } else {
                Err(format!("names no file: {error}"))
            };
        }
        (Err(error), code) => {
            return Err(format!("expected {code}, got [{}] {error}", error.code()));
        }
    };
    let grid = volume.grid();
    let statistics = volume.statistics();
    let mut wrong = Vec::new();
    let mut check = |what: &str, got: f64, want: f64, tolerance: f64| {
        if (got - want).abs() > tolerance * want.abs().max(1.0) {
            wrong.push(format!("{what} is {got}, not {want}"));
        }
    };
    let mut dims: Vec<u32> = numbers(row["dims"]);
    dims.resize(3, 1);
    for (got, want) in grid.dims.iter().zip(dims) {
        check("a dimension", f64::from(*got), f64::from(want), 0.0);
    }
    let columns: Vec<f64> = numbers(row["columns"]);
    for (got, want) in grid
        .world_from_index
        .matrix3
        .to_cols_array()
        .iter()
        .zip(columns)
    {
        check("a direction", *got, want, 1e-13);
    }
    for (got, want) in grid
        .origin()
        .to_array()
        .iter()
        .zip(numbers::<f64>(row["origin"]))
    {
        check("the origin", *got, want, 1e-13);
    }
    let number = |column: &str| row[column].parse::<f64>().unwrap();
    check("min", statistics.min, number("min"), 0.0);
    check("max", statistics.max, number("max"), 0.0);
    check("mean", statistics.mean, number("mean"), 1e-12);
    let (mut sum, mut i) = (0.0, 0_u64);
    volume.voxels().for_each(|value| {
        sum += value * (i % 1009) as f64;
        i += 1;
    });
    check(
        "the weighted mean",
        sum / i as f64,
        number("weighted"),
        1e-12,
    );
    if volume.voxels().scalar_type().name() != row["type"] {
        wrong.push(format!("type is {}", volume.voxels().scalar_type()));
    }
    if volume
        .source_files()
        .first()
        .is_none_or(|file| file != path)
    {
        wrong.push(format!("source files are {:?}", volume.source_files()));
    }
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(wrong.join("; "))
    }
}

fn failures(
    rows: &[HashMap<&str, &str>],
    path: impl Fn(&str) -> std::path::PathBuf,
) -> Vec<String> {
    rows.iter()
        .filter_map(|row| {
            let failure = compare(row, &path(row["file"])).err()?;
            Some(format!("{}: {failure}", row["file"]))
        })
        .collect()
}

#[test]
fn files_of_other_software_read_as_other_software_reads_them() {
    let Some(folder) = data_folder() else {
        println!(
            "no shared test data: the NRRD and MetaImage files of other software were not read"
        );
        return;
    };
    let rows = table(include_str!("expected_formats.tsv"));
    let failed = failures(&rows, |file| folder.join("formats").join(file));
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    // The table covers every header in the two folders.
    for kind in ["nrrd", "mhd"] {
        for entry in std::fs::read_dir(folder.join("formats").join(kind)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let header = [".nrrd", ".nhdr", ".mhd", ".mha"]
                .iter()
                .any(|end| name.ends_with(end));
            let file = format!("{kind}/{name}");
            assert!(
                !header || rows.iter().any(|row| row["file"] == file),
                "{file} is not in the table"
            );
        }
    }
}

#[test]
fn conventions_are_those_of_itk() {
    let folder = tempfile::tempdir().unwrap();
    let rows = table(include_str!("expected_conventions.tsv"));
    for row in &rows {
        let mut bytes = row["header"]
            .replace("\\r", "\r")
            .replace("\\n", "\n")
            .into_bytes();
        bytes.extend(unhex(row["data_hex"]));
        std::fs::write(folder.path().join(row["file"]), bytes).unwrap();
    }
    assert!(rows.len() > 25);
    let failed = failures(&rows, |file| folder.path().join(file));
    assert!(failed.is_empty(), "{}", failed.join("\n"));

    // The comparison sees each kind of difference.
    let good = rows
        .iter()
        .find(|row| row["file"] == "oblique.mha")
        .unwrap();
    for (column, other) in [
        ("type", "int8"),
        ("dims", "2 3 5"),
        ("columns", "1.6 1.2 0 1.8 2.4 0 0 0 4"),
        ("origin", "1 2 3.0001"),
        ("max", "24"),
        ("mean", "11.500001"),
        ("weighted", "1"),
        ("outcome", "volume-grid"),
    ] {
        let mut row = good.clone();
        row.insert(column, other);
        assert!(
            compare(&row, &folder.path().join("oblique.mha")).is_err(),
            "{column}"
        );
    }
}

#[test]
fn classic_raw_volumes_have_the_dimensions_and_ranges_of_the_manifest() {
    let Some(folder) = data_folder() else {
        println!("no shared test data: the classic raw volumes were not read");
        return;
    };
    let manifest = std::fs::read_to_string(folder.join("manifest.tsv")).unwrap();
    let mut read = 0;
    for row in table(&manifest) {
        let Some(name) = row["file"].strip_prefix("classic/") else {
            continue;
        };
        let volume = load(&folder.join(row["file"]), &LoadOptions::default()).unwrap();
        assert_eq!(
            volume.grid().dims.to_vec(),
            numbers::<u32>(row["dims_xyz"]),
            "{name}"
        );
        assert_eq!(volume.voxels().scalar_type().name(), row["dtype"], "{name}");
        let statistics = volume.statistics();
        let range = format!("{}..{}", statistics.min, statistics.max);
        assert_eq!(range, row["value_range"], "{name}");
        assert!(name.starts_with(volume.name()), "{name}");
        read += 1;
    }
    assert!(read >= 20, "{read}");
}
