//! DICOM, TIFF, PNG and JPEG against what pydicom, SimpleITK, tifffile and pillow read (`make_slices.py`).
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use common::{data_folder, numbers, table};
use volgraph_formats::{LoadOptions, VolumeReader};
use volgraph_volume::{Component, Values, Volume};

type Row<'a> = HashMap<&'a str, &'a str>;

fn rows() -> Vec<Row<'static>> {
    table(include_str!("expected_slices.tsv"))
}

fn beside(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(path)
}

fn read(path: &Path, options: &LoadOptions) -> Result<(Volume, u32), volgraph_volume::VolumeError> {
    let reader = VolumeReader::open(path, options)?;
    Ok((reader.read(options.time)?, reader.step_count()))
}

/// What is wrong with the outcome of a row.
fn compare(row: &Row<'_>, path: &Path) -> Result<(), String> {
    let options = LoadOptions {
        part: Some(row["part"].to_owned()).filter(|part| !part.is_empty()),
        component: row["component"].parse().ok().map(Component::Index),
        time: row["step"].parse().ok(),
        ..LoadOptions::default()
    };
    let (volume, steps) = match (read(path, &options), row["outcome"]) {
        (Ok(read), "ok") => read,
        (Ok(_), code) => return Err(format!("read, but expected {code}")),
        (Err(error), code) => {
            let text = error.to_string();
            let good = error.code() == code
                && text.contains(row["warns"])
                && text.contains(&*path.file_name().unwrap().to_string_lossy())
                && !error.trouble().remedy.is_empty()
                && !text.contains("Secret");
            return if good { Ok(()) } else { Err(format!("expected {code}, got [{}] {text}", error.code())) };
        }
    };
    // Decoders of JPEG may round otherwise.
    let (each, mean) = if row["note"] == "lossy" { (3.0, 0.6) } else { (0.0, 0.0) };
    let mut wrong = Vec::new();
    let mut check = |what: &str, got: f64, want: f64, off: f64| {
        let scale = if off < 1e-6 { want.abs().max(1.0) } else { 1.0 };
        if (got - want).abs() > off * scale {
            wrong.push(format!("{what} is {got}, not {want}"));
        }
    };
    let grid = volume.grid();
    for (got, want) in grid.dims.iter().zip(numbers::<u32>(row["dims"])) {
        check("a dimension", f64::from(*got), f64::from(want), 0.0);
    }
    let columns = grid.world_from_index.matrix3.to_cols_array();
    for (got, want) in columns.iter().zip(numbers::<f64>(row["columns"])) {
        check("a direction", *got, want, 1e-7);
    }
    for (got, want) in grid.origin().to_array().iter().zip(numbers::<f64>(row["origin"])) {
        check("the origin", *got, want, 1e-7);
    }
    let number = |column: &str| row[column].parse::<f64>().unwrap();
    let statistics = volume.statistics();
    // Slopes that are no binary fractions are rounded in the type of the result.
    let rounding = if volume.voxels().scalar_type().is_float() { 1e-7 } else { 0.0 };
    check("min", statistics.min, number("min"), each + rounding);
    check("max", statistics.max, number("max"), each + rounding);
    check("mean", statistics.mean, number("mean"), mean + 1e-7);
    for probe in row["probes"].split(' ') {
        let (index, want) = probe.split_once(':').unwrap();
        let got = volume.voxels().get(index.parse().unwrap());
        check("a voxel", got, want.parse().unwrap(), each + rounding);
    }
    let (mut sum, mut i) = (0.0, 0_u64);
    volume.voxels().for_each(|value| {
        sum += value * (i % 1009) as f64;
        i += 1;
    });
    check("the weighted mean", sum / i as f64, number("weighted"), if each > 0.0 { 1009.0 } else { 1e-7 });
    if volume.voxels().scalar_type().name() != row["type"] {
        wrong.push(format!("type is {}", volume.voxels().scalar_type()));
    }
    if steps.to_string() != row["steps"] {
        wrong.push(format!("there are {steps} steps"));
    }
    let warnings = volume.warnings().join("; ");
    if !warnings.contains(row["warns"]) || (row["warns"].is_empty() && !quiet(&warnings)) {
        wrong.push(format!("warnings are {warnings:?}"));
    }
    if format!("{:?} {warnings}", volume.about()).contains("Secret") {
        wrong.push("the patient is named".into());
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("; ")) }
}

/// Warnings that come with every file of one slice, or with colours.
fn quiet(warnings: &str) -> bool {
    warnings.split("; ").all(|text| {
        text.is_empty() || text.contains("single slice") || text.contains("name the folder") || text.contains("distances of the pixels")
    })
}

fn failures(rows: &[Row<'_>]) -> Vec<String> {
    let failure = |row: &Row<'_>| {
        let failure = compare(row, &beside(row["path"])).err()?;
        Some(format!("{} {} {}: {failure}", row["path"], row["part"], row["step"]))
    };
    rows.iter().filter_map(failure).collect()
}

#[test]
fn slices_read_as_other_software_reads_them() {
    let rows: Vec<Row<'_>> = rows();
    let own: Vec<Row<'_>> = rows.into_iter().filter(|row| !row["path"].starts_with("formats/")).collect();
    assert!(own.len() > 100, "{}", own.len());
    let failed = failures(&own);
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), own.len(), failed.join("\n"));
}
