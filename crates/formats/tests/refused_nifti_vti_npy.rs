//! NIfTI, VTI and NumPy files with one thing wrong: each refused with its code, a cause that says it, and a remedy.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::expected::{compare, options, unpack};
use common::{gzip, table};
use volgraph_formats::{LoadOptions, load};

const NIFTI: &str = include_str!("expected_nifti.tsv");
const VTI: &str = include_str!("expected_vti.tsv");
const NPY: &str = include_str!("expected_npy.tsv");

/// A small file of a table.
fn file(text: &str, name: &str) -> Vec<u8> {
    let rows = table(text);
    let row = rows.iter().find(|row| row["file"] == name).unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::read(unpack(row, folder.path())).unwrap()
}

/// With other bytes from `at` on.
fn at(mut bytes: Vec<u8>, at: usize, new: &[u8]) -> Vec<u8> {
    bytes[at..at + new.len()].copy_from_slice(new);
    bytes
}

/// With one text for another.
fn with(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let place = bytes
        .windows(from.len())
        .position(|window| window == from.as_bytes());
    let place = place.unwrap_or_else(|| panic!("{from}"));
    [&bytes[..place], to.as_bytes(), &bytes[place + from.len()..]].concat()
}

/// A file's name and bytes, the code, and what the message must hold.
type Case = (&'static str, Vec<u8>, &'static str, &'static str);

#[rustfmt::skip]
fn nifti_cases() -> Vec<Case> {
    let one = || file(NIFTI, "sform.nii");
    let two = || file(NIFTI, "two_big_uint16.nii");
    let q = || file(NIFTI, "qform.nii");
    let packed = gzip(&one());
    let (i16s, f32s) = (|n: i16| n.to_le_bytes(), |n: f32| n.to_le_bytes());
    vec![
        ("a.nii", one()[..200].to_vec(), "volume-data-too-short", "200 bytes of a header of 348"),
        ("a.nii", two()[..400].to_vec(), "volume-data-too-short", "400 bytes of a header of 540"),
        ("a.nii", one()[..399].to_vec(), "volume-data-too-short", "47 bytes"),
        ("a.nii", [one(), vec![1]].concat(), "volume-data-too-long", "49 bytes"),
        ("a.nii.gz", packed[..packed.len() - 9].to_vec(), "volume-data-too-short", "2×3×4 int16"),
        ("a.nii.gz", gzip(&[one(), one()].concat()), "volume-data-too-long", "more than 48 bytes"),
        ("a.nii", b"GIF89a".to_vec(), "volume-wrong-content", "NIfTI"),
        ("a.nii", at(one(), 344, b"\0\0\0\0"), "volume-unsupported", "Analyze"),
        ("a.nii", at(one(), 344, b"ni1\0"), "volume-data-file", "a.img"),
        ("a.hdr", at(one(), 344, b"ni1\0"), "volume-data-file", "a.img"),
        ("a.nii", at(one(), 40, &i16s(0)), "volume-bad-value", "0 axes"),
        ("a.nii", at(one(), 40, &i16s(9)), "volume-bad-value", "axes"),
        ("a.nii", at(one(), 42, &i16s(0)), "volume-grid", "axis 1"),
        ("a.nii", at(one(), 42, &i16s(-5)), "volume-bad-value", "axis 1 has -5"),
        ("a.nii", at(one(), 42, &[0xff, 0x7f, 0xff, 0x7f, 0xff, 0x7f]), "volume-too-large", "32767"),
        ("a.nii", at(at(one(), 40, &i16s(6)), 48, &[1, 0, 1, 0, 3, 0]), "volume-unsupported", "axis 6"),
        ("a.nii", at(one(), 70, &i16s(32)), "volume-unsupported", "complex"),
        ("a.nii", at(one(), 70, &i16s(1536)), "volume-unsupported", "float128"),
        ("a.nii", at(one(), 70, &i16s(1)), "volume-unsupported", "bits"),
        ("a.nii", at(one(), 70, &i16s(3)), "volume-unknown-type", "datatype 3"),
        ("a.nii", at(one(), 108, &f32s(100.0)), "volume-bad-value", "vox_offset"),
        ("a.nii", at(one(), 108, &f32s(f32::NAN)), "volume-bad-value", "vox_offset"),
        ("a.nii", at(one(), 108, &f32s(1e30)), "volume-bad-value", "vox_offset"),
        ("a.nii", at(one(), 112, &[f32s(2.0), f32s(f32::NAN)].concat()), "volume-bad-value", "scl_inter"),
        ("a.nii", at(one(), 280, &f32s(f32::NAN)), "volume-grid", "not finite"),
        ("a.nii", at(one(), 280, &[0; 48]), "volume-grid", "spacing"),
        ("a.nii", at(q(), 256, &[f32s(0.9), f32s(0.9)].concat()), "volume-grid", "quaternion"),
        ("a.nii", at(two(), 0, &[0; 4]), "volume-bad-value", "540"),
        ("a.nii", at(two(), 4, b"n+3\0"), "volume-header-syntax", "n+3"),
        ("a.nii", at(two(), 8, b"\n\x1a\n\0"), "volume-data-corrupt", "line ends"),
        ("a.nii", at(two(), 24, &[0x7f; 8]), "volume-too-large", "axis 1"),
        ("a.nii", at(two(), 24, &[0xff; 8]), "volume-bad-value", "axis 1 has -1"),
    ]
}

#[rustfmt::skip]
fn vti_cases() -> Vec<Case> {
    let text = || file(VTI, "ascii.vti");
    let raw = || file(VTI, "appended_raw_zlib.vti");
    let base = || file(VTI, "binary_lz4.vti");
    let two = || with(&file(VTI, "two.vti"), " Scalars=\"density\"", "");
    let plain = || file(VTI, "binary_none.vti");
    // The first block's length, and the compressed one, of appended raw bytes.
    let start = raw().windows(2).position(|window| window == b" _").unwrap() + 2;
    let twice = "<Piece Extent=\"0 1 0 0 0 0\"><PointData><DataArray type=\"Int8\" Name=\"a\">1 2</DataArray></PointData></Piece>";
    let twice = format!("<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 3 0 0 0 0\">{twice}{twice}</ImageData></VTKFile>");
    let long = "0 2000000000 0 2000000000 0 2000000000";
    vec![
        ("a.vti", b"GIF89a".to_vec(), "volume-wrong-content", "VTI"),
        ("a.vti", text()[..300].to_vec(), "volume-header-syntax", "byte 286"),
        ("a.vti", with(&text(), "</VTKFile>", ""), "volume-data-too-short", "</VTKFile>"),
        ("a.vti", with(&text(), "<PointData", "<PointDada"), "volume-header-syntax", "XML"),
        ("a.vti", with(&text(), "type=\"ImageData\"", "type=\"PolyData\""), "volume-unsupported", "PolyData"),
        ("a.vti", with(&text(), "LittleEndian", "MiddleEndian"), "volume-bad-value", "byte_order"),
        ("a.vti", with(&text(), "UInt32", "UInt31"), "volume-bad-value", "header_type"),
        ("a.vti", with(&raw(), "vtkZLib", "vtkGLib"), "volume-unsupported", "vtkGLib"),
        ("a.vti", with(&text(), "WholeExtent", "WholeExtend"), "volume-missing-field", "WholeExtent"),
        ("a.vti", with(&text(), "WholeExtent=\"0 4 0", "WholeExtent=\"0 4 x"), "volume-bad-value", "WholeExtent"),
        ("a.vti", with(&text(), "WholeExtent=\"0 4 0", "WholeExtent=\"9 4 0"), "volume-grid", "9 to 4"),
        ("a.vti", with(&text(), "WholeExtent=\"0 4 0 3 0 2", &format!("WholeExtent=\"{long}")), "volume-too-large", "2000000001"),
        ("a.vti", with(&text(), "WholeExtent=\"0 4", "WholeExtent=\"0 5"), "volume-bad-value", "cover"),
        ("a.vti", twice.into_bytes(), "volume-bad-value", "do not cover"),
        ("a.vti", with(&text(), "Piece Extent=\"0 4", "Piece Extent=\"0 5"), "volume-bad-value", "outside"),
        ("a.vti", with(&text(), "Spacing=\"0.5", "Spacing=\"0"), "volume-grid", "zero"),
        ("a.vti", with(&text(), "Direction=\"1 0 0 0 1", "Direction=\"1 1 0 1 1"), "volume-grid", "plane"),
        ("a.vti", with(&text(), "Direction=\"1 0 0 0 1", "Direction=\"1 0 0 0"), "volume-bad-value", "Direction"),
        ("a.vti", with(&text(), "Float32", "Float31"), "volume-unknown-type", "Float31"),
        ("a.vti", with(&text(), "Float32\"", "Float32\" NumberOfComponents=\"-1\""), "volume-bad-value", "components"),
        ("a.vti", with(&text(), "Float32\"", "Float32\" NumberOfComponents=\"3\""), "volume-component", "3 values"),
        ("a.vti", with(&text(), "\"ascii\"", "\"morse\""), "volume-bad-value", "morse"),
        ("a.vti", with(&text(), "0 7 14", "0 7"), "volume-data-too-short", "59 numbers"),
        ("a.vti", with(&text(), "0 7 14", "0 7 14 15"), "volume-data-too-long", "more than the 60"),
        ("a.vti", with(&text(), "0 7 14", "0 7 xy"), "volume-data-corrupt", "xy"),
        ("a.vti", two(), "volume-option", "density, Temperature"),
        ("a.vti", with(&raw(), "offset=\"0\"", "offset=\"9999\""), "volume-data-too-short", "begins"),
        ("a.vti", with(&raw(), "offset=\"0\"", "other=\"0\""), "volume-missing-field", "offset"),
        ("a.vti", raw()[..start + 40].to_vec(), "volume-data-too-short", "compressed"),
        ("a.vti", at(raw(), start, &[0xff; 4]), "volume-data-too-short", "4294967295 compressed blocks"),
        ("a.vti", at(raw(), start + 4, &[0xff; 4]), "volume-data-too-long", "compressed blocks"),
        ("a.vti", at(raw(), start + 12, &[0xff; 4]), "volume-data-too-short", "compressed"),
        ("a.vti", at(raw(), start + 24, &[0xff; 4]), "volume-data-corrupt", "decoded"),
        ("a.vti", with(&base(), "AgAAAEAAAAA", "Ag!AAEAAAAA"), "volume-data-corrupt", "decoded"),
        ("a.vti", with(&plain(), "eAAAAA", "eQAAAA"), "volume-data-too-long", "121 bytes"),
        ("a.vti", with(&plain(), "eAAAAA", "dwAAAA"), "volume-data-too-short", "119 bytes"),
    ]
}

#[rustfmt::skip]
fn npy_cases() -> Vec<Case> {
    let good = || file(NPY, "little_f4.npy");
    let nested = |n: usize| with(&good(), "(3, 4, 5)", &"(".repeat(n));
    vec![
        ("a.npy", good()[..9].to_vec(), "volume-data-too-short", "header"),
        ("a.npy", good()[..90].to_vec(), "volume-data-too-short", "header"),
        ("a.npy", good()[..200].to_vec(), "volume-data-too-short", "72 bytes"),
        ("a.npy", [good(), vec![0]].concat(), "volume-data-too-long", "241 bytes"),
        ("a.npy", b"PK\x03\x04".to_vec(), "volume-wrong-content", "NumPy"),
        ("a.npy", at(good(), 6, &[4]), "volume-unsupported", "version 4.0"),
        ("a.npy", at(good(), 6, &[2, 0, 0xff, 0xff, 0xff, 0xff]), "volume-header-syntax", "4294967295 bytes"),
        ("a.npy", with(&good(), "'shape'", "'shade'"), "volume-header-syntax", "shade"),
        ("a.npy", with(&good(), "'descr'", "'deskr'"), "volume-header-syntax", "descr"),
        ("a.npy", with(&good(), "(3, 4, 5), }     ", "(3000000000, 4, 5), }"), "volume-too-large", "limit"),
        ("a.npy", with(&good(), "(3, 4, 5), }           ", "(18446744073709551615)"), "volume-too-large", "2^63"),
        ("a.npy", with(&good(), "(3, 4, 5), }                ", "(4294967296, 4294967296), }"), "volume-too-large", "2^63"),
        ("a.npy", with(&good(), "(3, 4, 5)", "(3, -4,5)"), "volume-header-syntax", "-4"),
        ("a.npy", with(&good(), "(3, 4, 5)", "(3, 0, 5)"), "volume-grid", "no samples"),
        ("a.npy", with(&good(), "<f4", "<f9"), "volume-header-syntax", "f9"),
        ("a.npy", nested(9), "volume-header-syntax", "what NumPy writes"),
    ]
}

fn check(case: &Case) -> Result<(), String> {
    let (name, bytes, code, says) = case;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let Err(error) = load(&path, &LoadOptions::default()) else {
        return Err("was read".to_owned());
    };
    let text = error.to_string();
    let folder_named = text.contains(&*folder.path().to_string_lossy());
    if error.code() != *code
        || !text.contains(says)
        || !folder_named
        || error.trouble().remedy.is_empty()
    {
        return Err(format!("[{}] {text}", error.code()));
    }
    Ok(())
}

#[test]
fn broken_files_are_refused_with_their_reason() {
    let cases: Vec<Case> = [nifti_cases(), vti_cases(), npy_cases()].concat();
    assert!(cases.len() > 80, "{}", cases.len());
    let failed: Vec<String> = cases
        .iter()
        .filter_map(|case| {
            Some(format!(
                "{} ({}, {:?}): {}",
                case.0,
                case.2,
                case.3,
                check(case).err()?
            ))
        })
        .collect();
    assert!(
        failed.is_empty(),
        "{} failed:\n{}",
        failed.len(),
        failed.join("\n")
    );
    // The check sees a file that is read.
    let good = ("a.nii", file(NIFTI, "sform.nii"), "volume-grid", "");
    assert_eq!(check(&good), Err("was read".to_owned()));
}

#[test]
fn arrays_are_named_by_a_part_of_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let rows = table(VTI);
    let row = rows.iter().find(|row| row["file"] == "two.vti").unwrap();
    let path = unpack(row, folder.path());
    let part = |part: &str| {
        let part = Some(part.to_owned());
        load(
            &path,
            &LoadOptions {
                part,
                ..options(row)
            },
        )
    };
    assert!(compare(row, &path).is_ok());
    assert_eq!(
        part("emp").unwrap().digest(),
        part("Temperature").unwrap().digest()
    );
    let active = load(&path, &LoadOptions::default()).unwrap();
    assert_eq!(active.digest(), part("density").unwrap().digest());
    for (name, says) in [
        ("e", "density, Temperature"),
        ("colour", "one of density, Temperature"),
    ] {
        let error = part(name).unwrap_err();
        assert!(
            error.code() == "volume-option" && error.to_string().contains(says),
            "{error}"
        );
    }
}

#[test]
fn a_pair_in_a_folder_is_one_volume() {
    let folder = tempfile::tempdir().unwrap();
    let rows = table(NIFTI);
    let row = rows.iter().find(|row| row["file"] == "pair.hdr").unwrap();
    let path = unpack(row, folder.path());
    let by_folder = load(folder.path(), &LoadOptions::default()).unwrap();
    let by_header = load(&path, &LoadOptions::default()).unwrap();
    assert_eq!(by_folder.digest(), by_header.digest());
    assert!(
        by_header
            .source_files()
            .contains(&path.with_extension("img"))
    );
}
