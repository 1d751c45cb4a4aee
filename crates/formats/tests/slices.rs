//! DICOM, TIFF, PNG and JPEG against what pydicom, SimpleITK, tifffile and pillow read (`make_slices.py`).
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use common::{data_folder, numbers, table};
use std::sync::{Arc, Mutex};

use volgraph_formats::{LoadOptions, VolumeReader, from_bytes, load};
use volgraph_volume::{Component, Values, Volume};

type Row<'a> = HashMap<&'a str, &'a str>;

fn rows() -> Vec<Row<'static>> {
    table(include_str!("expected_slices.tsv"))
}

fn beside(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(path)
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
            return if good {
                Ok(())
            } else {
                Err(format!("expected {code}, got [{}] {text}", error.code()))
            };
        }
    };
    // Decoders of JPEG may round otherwise.
    let (each, mean) = if row["note"] == "lossy" {
        (3.0, 0.6)
    } else {
        (0.0, 0.0)
    };
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
    for (got, want) in grid
        .origin()
        .to_array()
        .iter()
        .zip(numbers::<f64>(row["origin"]))
    {
        check("the origin", *got, want, 1e-7);
    }
    let number = |column: &str| row[column].parse::<f64>().unwrap();
    let statistics = volume.statistics();
    // Slopes that are no binary fractions are rounded in the type of the result.
    let rounding = if volume.voxels().scalar_type().is_float() {
        1e-7
    } else {
        0.0
    };
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
    check(
        "the weighted mean",
        sum / i as f64,
        number("weighted"),
        if each > 0.0 { 1009.0 } else { 1e-7 },
    );
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
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(wrong.join("; "))
    }
}

/// Warnings that come with every file of one slice, or with colours.
fn quiet(warnings: &str) -> bool {
    warnings.split("; ").all(|text| {
        text.is_empty()
            || text.contains("single slice")
            || text.contains("name the folder")
            || text.contains("distances of the pixels")
    })
}

fn failures(rows: &[Row<'_>]) -> Vec<String> {
    let failure = |row: &Row<'_>| {
        let failure = compare(row, &beside(row["path"])).err()?;
        Some(format!(
            "{} {} {}: {failure}",
            row["path"], row["part"], row["step"]
        ))
    };
    rows.iter().filter_map(failure).collect()
}

#[test]
fn slices_read_as_other_software_reads_them() {
    let rows: Vec<Row<'_>> = rows();
    let own: Vec<Row<'_>> = rows
        .into_iter()
        .filter(|row| !row["path"].starts_with("formats/"))
        .collect();
    assert!(own.len() > 100, "{}", own.len());
    let failed = failures(&own);
    assert!(
        failed.is_empty(),
        "{} of {}:\n{}",
        failed.len(),
        own.len(),
        failed.join("\n")
    );
}

#[test]
fn the_comparison_sees_each_kind_of_difference() {
    let all = rows();
    let row = |path: &str| all.iter().find(|row| row["path"] == path).unwrap().clone();
    for (path, column, other) in [
        ("dicom/ct_oblique", "type", "int32"),
        ("dicom/ct_oblique", "dims", "6 8 5"),
        (
            "dicom/ct_oblique",
            "columns",
            "1.2 0.9 0 -0.72 0.96 1.6001 1.44 -1.92 1.8",
        ),
        ("dicom/ct_oblique", "origin", "10 -20 5.1"),
        ("dicom/ct_oblique", "mean", "0"),
        ("dicom/ct_oblique", "weighted", "1"),
        ("dicom/ct_oblique", "probes", "3:99999"),
        ("dicom/tilt", "warns", "no such warning"),
        ("dicom/times", "steps", "3"),
        ("dicom/twice", "outcome", "volume-grid"),
        ("pictures/jpeg_gray", "max", "3"),
    ] {
        let mut changed = row(path);
        changed.insert(column, other);
        assert!(compare(&changed, &beside(path)).is_err(), "{path} {column}");
    }
}

#[test]
fn slices_of_the_test_data_read_as_other_software_reads_them() {
    let Some(data) = data_folder() else {
        println!("no shared test data: the DICOM series and the TIFF stack were not read");
        return;
    };
    let all = rows();
    let row = |path: &str| all.iter().find(|row| row["path"] == path).unwrap().clone();
    let series = row("formats/dicom_slicer_cthead");
    compare(&series, &data.join(series["path"])).unwrap();
    let packed = row("formats/tiff/cthead-8bit.zip");
    let folder = tempfile::tempdir().unwrap();
    let mut archive =
        zip::ZipArchive::new(std::fs::File::open(data.join(packed["path"])).unwrap()).unwrap();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).unwrap();
        let name = file.name().replace('\\', "/");
        let name = name.rsplit('/').next().unwrap().to_owned();
        if name.ends_with(".tif") {
            let mut out = std::fs::File::create(folder.path().join(name)).unwrap();
            std::io::copy(&mut file, &mut out).unwrap();
        }
    }
    compare(&packed, folder.path()).unwrap();
}

#[test]
fn what_the_values_mean_is_told() {
    let open = |path: &str| load(&beside(path), &LoadOptions::default()).unwrap();
    let ct = open("dicom/ct_oblique");
    assert_eq!(ct.about().values, Values::Hounsfield);
    assert_eq!(ct.about().value_unit.as_deref(), Some("HU"));
    assert_eq!(ct.about().length_unit.as_deref(), Some("mm"));
    assert_eq!(ct.name(), "ct_oblique");
    let fact = |volume: &Volume, name: &str| {
        let found = volume.about().facts.iter().find(|(fact, _)| fact == name);
        found.map(|(_, text)| text.clone())
    };
    assert_eq!(fact(&ct, "modality").as_deref(), Some("CT"));
    assert_eq!(fact(&ct, "series").as_deref(), Some("Oblique head"));
    assert_eq!(
        fact(&ct, "padding value before rescaling").as_deref(),
        Some("2096")
    );
    let pet = open("dicom/slopes");
    assert_eq!(
        (&pet.about().values, pet.about().value_unit.as_deref()),
        (&Values::Unknown, Some("BQML"))
    );
    let dose = open("dicom/dose.dcm");
    assert_eq!(dose.about().value_unit.as_deref(), Some("GY"));
    let labels = [(1, "liver".to_owned()), (2, "kidney".to_owned())]
        .into_iter()
        .collect();
    assert_eq!(
        open("dicom/segments.dcm").about().values,
        Values::Labels(labels)
    );
    let ome = LoadOptions {
        component: Some(Component::Index(0)),
        time: Some(1),
        ..LoadOptions::default()
    };
    let ome = load(&beside("tiff/ome_tczyx.ome.tif"), &ome).unwrap();
    assert_eq!(ome.about().length_unit.as_deref(), Some("µm"));
    let step = ome.about().step.clone().unwrap();
    assert_eq!((step.time, step.unit.as_deref()), (Some(0.1), Some("s")));
}

#[test]
fn pictures_in_colour_are_drawn_in_colour() {
    for path in [
        "pictures/rgb",
        "pictures/la",
        "dicom/rgb.dcm",
        "tiff/rgb.tif",
        "tiff/rgba.tif",
    ] {
        let volume = load(&beside(path), &LoadOptions::default()).unwrap();
        assert!(volume.colors().is_some(), "{path}");
    }
}

#[test]
fn progress_is_told_and_the_limit_is_kept() {
    let told = Arc::new(Mutex::new(Vec::new()));
    let into = Arc::clone(&told);
    let options = LoadOptions {
        progress: Some(Arc::new(move |done, total| {
            into.lock().unwrap().push((done, total));
        })),
        ..LoadOptions::default()
    };
    load(&beside("dicom/ct_oblique"), &options).unwrap();
    assert_eq!(told.lock().unwrap().last(), Some(&(384, 384)));
    let small = LoadOptions {
        max_bytes: Some(383),
        ..LoadOptions::default()
    };
    assert_eq!(
        load(&beside("dicom/ct_oblique"), &small)
            .unwrap_err()
            .code(),
        "volume-too-large"
    );
}

#[test]
fn a_forged_size_is_refused_before_anything_is_allocated() {
    let mut bytes = std::fs::read(beside("pictures/jpeg_gray/p0.jpg")).unwrap();
    let at = bytes
        .windows(2)
        .position(|two| two == [0xff, 0xc0])
        .unwrap();
    bytes[at + 5..at + 9].fill(0xff);
    let error = from_bytes("a.jpg", &bytes, &LoadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "volume-data-too-short", "{error}");
    let mut bytes = std::fs::read(beside("dicom/jpeg_2000.dcm")).unwrap();
    for tag in [[0x28, 0, 0x10, 0], [0x28, 0, 0x11, 0]] {
        let at = bytes.windows(4).position(|four| four == tag).unwrap();
        bytes[at + 8..at + 10].fill(0xff);
    }
    let error = from_bytes("a.dcm", &bytes, &LoadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "volume-data-too-short", "{error}");
}

/// A small generator, so that a failing mutant can be made again.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        match random.below(6) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.below(256) as u8,
            2 => bytes.truncate(at.max(1)),
            3 => {
                // A length or size that nothing is behind.
                let forged = [0xff_u8, 0x7f, 0x00, 0xfe][random.below(4)];
                let end = (at + 1 + random.below(4)).min(bytes.len());
                bytes[at..end].fill(forged);
            }
            4 => {
                let end = (at + random.below(40)).min(bytes.len());
                bytes.drain(at..end);
            }
            _ => {
                let end = (at + random.below(40)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
        }
        if bytes.is_empty() {
            bytes.push(0);
        }
    }
}

#[test]
fn mutants_are_read_or_refused_with_a_word() {
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in [
        "dicom",
        "dicom/ct_oblique",
        "tiff",
        "pictures/rgb",
        "pictures/gray16",
        "pictures/palette",
        "pictures/jpeg_gray",
        "pictures/jpeg_rgb",
    ] {
        let entries = std::fs::read_dir(beside(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path());
        files.extend(entries.filter(|path| path.is_file()));
    }
    files.sort();
    assert!(files.len() > 80);
    let mut refused = 0;
    for (seed, path) in files.iter().enumerate() {
        let whole = std::fs::read(path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let mut random = Random(seed as u64);
        for mutant in 0..400 {
            let mut bytes = whole.clone();
            mutate(&mut bytes, &mut random);
            let options = LoadOptions {
                component: (mutant % 2 == 0).then_some(Component::Magnitude),
                max_bytes: Some(1 << 24),
                ..LoadOptions::default()
            };
            match from_bytes(name, &bytes, &options) {
                Ok(volume) => assert_eq!(volume.voxels().len() as u64, volume.grid().voxel_count()),
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().contains(name), "{name} {mutant}: {error}");
                    assert!(
                        !error.trouble().remedy.is_empty() && !error.trouble().cause.is_empty()
                    );
                    assert!(
                        !error.to_string().contains("decoder fails"),
                        "an assertion in a crate: {name} {mutant}"
                    );
                }
            }
        }
    }
    assert!(refused > 1000, "{refused}");
}
