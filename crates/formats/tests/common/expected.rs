//! Rows of the tables that `make_expected_nifti_vti_npy.py` writes, and what a volume must be by them.

use std::collections::HashMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use volgraph_formats::{LoadOptions, load};

use super::{numbers, unhex};

pub type Row<'t> = HashMap<&'t str, &'t str>;

/// Writes the files of a row into a folder; gives the path of the one to be read.
pub fn unpack(row: &Row<'_>, folder: &Path) -> PathBuf {
    for file in row["bytes"].split_whitespace() {
        let (name, packed) = file.split_once(':').unwrap();
        let mut bytes = Vec::new();
        flate2::read::ZlibDecoder::new(unhex(packed).as_slice())
            .read_to_end(&mut bytes)
            .unwrap();
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    folder.join(row["file"])
}

pub fn options(row: &Row<'_>) -> LoadOptions {
    LoadOptions {
        part: Some(row["part"].to_owned()).filter(|part| !part.is_empty()),
        component: row["component"].parse().ok(),
        time: row["time"].parse().ok(),
        ..LoadOptions::default()
    }
}

/// What is wrong with the outcome of a row.
pub fn compare(row: &Row<'_>, path: &Path) -> Result<(), String> {
    let volume = match (load(path, &options(row)), row["outcome"]) {
        (Ok(volume), "ok") => volume,
        (Ok(_), code) => return Err(format!("read, but expected {code}")),
        (Err(error), code) => {
            let named = error.to_string().contains(&*path.to_string_lossy());
            let told = !error.trouble().remedy.is_empty() && named;
            return if error.code() == code && told {
                Ok(())
            } else {
                Err(format!("expected {code}, got [{}] {error}", error.code()))
            };
        }
    };
    let grid = volume.grid();
    let mut wrong = Vec::new();
    let mut check = |what: &str, got: f64, want: f64, tolerance: f64| {
        // Not a number is as good as itself.
        let same =
            got.is_nan() && want.is_nan() || (got - want).abs() <= tolerance * want.abs().max(1.0);
        if !same {
            wrong.push(format!("{what} is {got}, not {want}"));
        }
    };
    for (got, want) in grid.dims.iter().zip(numbers::<u32>(row["dims"])) {
        check("a dimension", f64::from(*got), f64::from(want), 0.0);
    }
    let columns = grid.world_from_index.matrix3.to_cols_array();
    for (got, want) in columns.iter().zip(numbers::<f64>(row["columns"])) {
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
    let statistics = volume.statistics();
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
    for probe in row["probes"].split_whitespace() {
        let (index, value) = probe.split_once(':').unwrap();
        let got = volume.voxels().get(index.parse().unwrap());
        check(&format!("voxel {index}"), got, value.parse().unwrap(), 0.0);
    }
    let about = volume.about();
    let step_time = about.step.as_ref().and_then(|step| step.time);
    for (what, got, want) in [
        (
            "the type",
            volume.voxels().scalar_type().name().to_owned(),
            row["type"],
        ),
        (
            "the unit",
            about.length_unit.clone().unwrap_or_default(),
            row["unit"],
        ),
        (
            "the time",
            step_time.map_or_else(String::new, |time| format!("{time:?}")),
            row["step_time"],
        ),
    ] {
        if got != want {
            wrong.push(format!("{what} is {got:?}, not {want:?}"));
        }
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

/// Compares all rows: those with bytes in a folder of their own, the others in the folder of test data where it is.
/// Gives whether that is there.
pub fn compare_all(table: &str) -> bool {
    let rows = super::table(table);
    let data = super::data_folder();
    let mut failed = Vec::new();
    for row in &rows {
        let folder = tempfile::tempdir().unwrap();
        let path = match (row["bytes"], &data) {
            ("", Some(data)) => data.join("formats").join(row["file"]),
            ("", None) => continue,
            _ => unpack(row, folder.path()),
        };
        if let Err(failure) = compare(row, &path) {
            failed.push(format!("{}: {failure}", row["file"]));
        }
    }
    assert!(
        failed.is_empty(),
        "{} of {}:\n{}",
        failed.len(),
        rows.len(),
        failed.join("\n")
    );

    // The comparison sees each kind of difference.
    let good = rows
        .iter()
        .find(|row| row["outcome"] == "ok" && !row["bytes"].is_empty())
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = unpack(good, folder.path());
    for column in [
        "type",
        "dims",
        "columns",
        "origin",
        "min",
        "max",
        "mean",
        "weighted",
        "probes",
        "unit",
        "step_time",
    ] {
        let mut row = good.clone();
        row.insert(
            column,
            match column {
                "type" | "unit" | "step_time" => "other",
                "probes" => "5:-77.5",
                _ => "-77 -78 -79 -80",
            },
        );
        if matches!(column, "min" | "max" | "mean" | "weighted") {
            row.insert(column, "-77.5");
        }
        if column == "dims" {
            row.insert(column, "77 78 79");
        }
        assert!(compare(&row, &path).is_err(), "{column}");
    }
    let mut row = good.clone();
    row.insert("outcome", "volume-grid");
    assert!(compare(&row, &path).is_err());
    data.is_some()
}
