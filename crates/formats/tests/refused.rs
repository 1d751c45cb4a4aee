//! Bad files: each refused with its code, naming the file, the line where there is one, cause and remedy.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::path::Path;

use common::{bzip2, gzip, zlib};
use volgraph_formats::{LoadOptions, load};
use volgraph_report::Finding;

const NRRD: &str =
    "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 4 4\nendian: little\nencoding: raw\n";
const META: &str = "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_SHORT\n";

struct Case {
    name: &'static str,
    bytes: Vec<u8>,
    code: &'static str,
    /// Part of the name of the file that the message must name, where it is not `name`.
    names: &'static str,
    /// The header line, 0 for the whole file.
    line: u32,
}

fn case(name: &'static str, bytes: impl Into<Vec<u8>>, code: &'static str, line: u32) -> Case {
    Case {
        name,
        bytes: bytes.into(),
        code,
        names: name,
        line,
    }
}

fn nrrd(from: &str, to: &str, data: &[u8]) -> Vec<u8> {
    assert!(from.is_empty() || NRRD.contains(from), "{from}");
    let header = if from.is_empty() {
        format!("{NRRD}{to}")
    } else {
        NRRD.replace(from, to)
    };
    [header.as_bytes(), b"\n", data].concat()
}

fn meta(from: &str, to: &str, data: &[u8]) -> Vec<u8> {
    assert!(from.is_empty() || META.contains(from), "{from}");
    let header = if from.is_empty() {
        format!("{META}{to}")
    } else {
        META.replace(from, to)
    };
    [header.as_bytes(), b"ElementDataFile = LOCAL\n", data].concat()
}

#[rustfmt::skip]
fn raw_cases(full: &[u8]) -> Vec<Case> {
    let half = &full[..64];
    let long = [full, full].concat();
    let packed = gzip(full);
    let mut broken = packed.clone();
    broken[12] ^= 0xff;
    let mut wrong_sum = packed.clone();
    let at = wrong_sum.len() - 6;
    wrong_sum[at] ^= 1;
    vec![
        case("a_4x4x4_int16.raw", half, "volume-data-too-short", 0),
        case("a_4x4x4_int16.raw", &long[..], "volume-data-too-long", 0),
        case("a_4x4x4_int16.raw", [full, b"\n"].concat(), "volume-data-too-long", 0),
        case("a_4x4x4_int16.raw.gz", gzip(half), "volume-data-too-short", 0),
        case("a_4x4x4_int16.raw.gz", gzip(&long), "volume-data-too-long", 0),
        case("a_4x4x4_int16.raw.gz", &packed[..packed.len() / 2], "volume-data-too-short", 0),
        case("a_4x4x4_int16.raw.gz", &packed[..packed.len() - 4], "volume-data-too-short", 0),
        case("a_4x4x4_int16.raw.gz", broken, "volume-data-corrupt", 0),
        case("a_4x4x4_int16.raw.gz", wrong_sum, "volume-data-corrupt", 0),
        case("a_4x4x4_int16.raw.gz", [&packed[..], b"junk junk junk"].concat(), "volume-data-corrupt", 0),
        case("a_4x4x4_int61.raw", full, "volume-unknown-type", 0),
        case("a_4x0x4_int16.raw", full, "volume-grid", 0),
        case("a_4x-4x4_int16.raw", full, "volume-raw-name", 0),
        case("a_10000x10000x10000_uint8.raw", full, "volume-too-large", 0),
        case("a_2000x2000x2000_uint8.raw", full, "volume-data-too-short", 0),
        case("a_2000x2000x2000_uint8.raw.gz", packed.clone(), "volume-data-too-short", 0),
        case("a_4000000000x4000000000x4000000000_uint8.raw", full, "volume-too-large", 0),
        case("engine.raw", full, "volume-raw-name", 0),
        case("text_4x4x4_int16.raw", "dear reader, this is text", "volume-data-too-short", 0),
        case("empty_4x4x4_int16.raw", "", "volume-data-too-short", 0),
        case("notes.txt", "dear reader", "volume-unknown-format", 0),
        case("brain.nii", b"\x5c\x01\0\0 and more".as_slice(), "volume-data-too-short", 0),
    ]
}

#[rustfmt::skip]
fn nrrd_cases(full: &[u8]) -> Vec<Case> {
    let gif = b"GIF89a\x04\0\x04\0\x80\0\0\0\0\0".as_slice();
    let packed = gzip(full);
    let blocks = bzip2(full);
    let three = "dimension: 3\nsizes: 4 4 4";
    let directions = "space: left-posterior-superior\nspace directions: ";
    let missing = Case {
        names: "gone.raw",
        ..case(
            "a.nhdr",
            nrrd("", "data file: gone.raw\n", b""),
            "volume-data-file",
            0,
        )
    };
    let folder = Case {
        names: "folder",
        ..case(
            "a.nhdr",
            nrrd("", "data file: folder\n", b""),
            "volume-data-file",
            0,
        )
    };
    vec![
        missing,
        folder,
        case("a.nhdr", nrrd("", "data file: a.nhdr\n", b""), "volume-data-file", 0),
        case("a.nhdr", nrrd("", "data file: ./folder/../a.nhdr\n", b""), "volume-data-file", 0),
        case("a.nhdr", nrrd("", "data file: LIST\n", b""), "volume-bad-value", 7),
        case("a.nrrd", gif, "volume-wrong-content", 0),
        case("a.nrrd", "", "volume-wrong-content", 0),
        case("a.nrrd", nrrd("", "", &full[1..]), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("", "", &[full, b"xyz"].concat()), "volume-data-too-long", 0),
        case("a.nrrd", nrrd("raw", "gzip", &packed[..packed.len() - 9]), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("raw", "gzip", &gzip(&[full, full].concat())), "volume-data-too-long", 0),
        case("a.nrrd", nrrd("raw", "gzip", full), "volume-data-corrupt", 0),
        case("a.nrrd", nrrd("raw", "bzip2", &blocks[..blocks.len() - 9]), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("raw", "bzip2", &bzip2(&[full, b"x"].concat())), "volume-data-too-long", 0),
        case("a.nrrd", nrrd("raw", "bzip2", full), "volume-data-corrupt", 0),
        case("a.nrrd", nrrd("raw", "hex", b"0011zz"), "volume-data-corrupt", 0),
        case("a.nrrd", nrrd("raw", "hex", b"001"), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("raw", "ascii", &b"7 ".repeat(63)), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("raw", "ascii", &b"7 ".repeat(65)), "volume-data-too-long", 0),
        case("a.nrrd", nrrd("raw", "ascii", &b"7e9 ".repeat(64)), "volume-data-corrupt", 0),
        case("a.nrrd", nrrd("raw", "zrl", full), "volume-unsupported", 6),
        case("a.nrrd", nrrd("4 4 4", "10000 10000 10000", full), "volume-too-large", 0),
        case("a.nrrd", nrrd("4 4 4", "1000000000000 1 1", full), "volume-too-large", 4),
        case("a.nrrd", nrrd("4 4 4", "18446744073709551615 2 2", full), "volume-too-large", 4),
        case("a.nrrd", nrrd("4 4 4", "4 4", full), "volume-bad-value", 4),
        case("a.nrrd", nrrd("4 4 4", "4 four 4", full), "volume-bad-value", 4),
        case("a.nrrd", nrrd("4 4 4", "4 -4 4", full), "volume-bad-value", 4),
        case("a.nrrd", nrrd("4 4 4", "4 0 4", full), "volume-grid", 4),
        case("a.nrrd", nrrd("dimension: 3", "dimension: 99999999999", full), "volume-bad-value", 3),
        case("a.nrrd", nrrd(three, "dimension: 4\nsizes: 2 2 4 4", full), "volume-unsupported", 4),
        case("a.nrrd", nrrd(three, "dimension: 4\nsizes: 2 2 4 4\nkinds: vector space space space", full), "volume-component", 4),
        case("a.nrrd", nrrd("short", "shirt", full), "volume-unknown-type", 2),
        case("a.nrrd", nrrd("short", "block", full), "volume-unsupported", 2),
        case("a.nrrd", nrrd("endian: little\n", "", full), "volume-missing-field", 0),
        case("a.nrrd", nrrd("endian: little", "endian: middle", full), "volume-bad-value", 5),
        case("a.nrrd", nrrd("type: short\n", "", full), "volume-missing-field", 0),
        case("a.nrrd", nrrd("NRRD0004", "NRRD0009", full), "volume-unsupported", 1),
        case("a.nrrd", nrrd("", "no colon here\n", full), "volume-header-syntax", 7),
        case("a.nrrd", nrrd("", "type: short\n", full), "volume-header-syntax", 7),
        case("a.nrrd", [NRRD.as_bytes(), b"kinds: \xff\xfe\n\n", full].concat(), "volume-header-syntax", 7),
        case("a.nrrd", nrrd("", &format!("kinds: {}\n", "x".repeat(5 << 20)), full), "volume-header-syntax", 0),
        case("a.nrrd", nrrd("", &format!("# {}\n", "x".repeat(5 << 20)), full), "volume-header-syntax", 0),
        case("a.nrrd", nrrd("", "spacings: 1 nan 1\n", full), "volume-bad-value", 7),
        case("a.nrrd", nrrd("", "spacings: 1 inf 1\n", full), "volume-grid", 7),
        case("a.nrrd", nrrd("", "spacings: 1 0 1\n", full), "volume-grid", 7),
        case("a.nrrd", nrrd("", "spacings: 1 1e999 1\n", full), "volume-grid", 7),
        case("a.nrrd", nrrd("", &format!("{directions}(1,0,0) (1,0,0) (0,0,1)\n"), full), "volume-grid", 8),
        case("a.nrrd", nrrd("", &format!("{directions}(1,0,0) (0,nan,0) (0,0,1)\n"), full), "volume-grid", 8),
        case("a.nrrd", nrrd("", &format!("{directions}(1,0,0) (0,1) (0,0,1)\n"), full), "volume-bad-value", 8),
        case("a.nrrd", nrrd("", &format!("{directions}none none none\n"), full), "volume-unsupported", 4),
        case("a.nrrd", nrrd("", "space: outer\n", full), "volume-unsupported", 7),
        case("a.nrrd", nrrd("", "byte skip: 1\n", full), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("", "byte skip: -99999\n", full), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("", "byte skip: -9223372036854775808\n", full), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("", "byte skip: 9223372036854775807\n", full), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("", "line skip: 1000000000000000\n", full), "volume-data-too-short", 0),
        case("a.nrrd", nrrd("raw", "gzip\nbyte skip: -9223372036854775808", &packed), "volume-data-too-short", 0),
    ]
}

#[rustfmt::skip]
fn meta_cases(full: &[u8]) -> Vec<Case> {
    let packed = zlib(full);
    let zip = "CompressedData = True\n";
    let size = |n: usize| format!("{zip}CompressedDataSize = {n}\n");
    let mut wrong_sum = packed.clone();
    *wrong_sum.last_mut().unwrap() ^= 1;
    let list = format!("{META}ElementDataFile = LIST\na.raw\nb.raw\nc.raw\n");
    let missing = format!("{META}ElementDataFile = gone.raw\n");
    let itself = format!("{META}ElementDataFile = a.mhd\n");
    vec![
        Case { names: "gone.raw", ..case("a.mhd", missing, "volume-data-file", 0) },
        case("a.mhd", itself, "volume-data-file", 0),
        Case { names: "a.raw", ..case("a.mhd", list, "volume-data-file", 0) },
        case("a.mha", META, "volume-missing-field", 0),
        case("a.mha", "PK\x03\x04", "volume-wrong-content", 0),
        case("a.mha", meta("", "", &full[1..]), "volume-data-too-short", 0),
        case("a.mha", meta("", "", &[full, full].concat()), "volume-data-too-long", 0),
        case("a.mha", meta("", zip, &packed[..packed.len() / 2]), "volume-data-too-short", 0),
        case("a.mha", meta("", zip, &wrong_sum), "volume-data-corrupt", 0),
        case("a.mha", meta("", zip, full), "volume-data-corrupt", 0),
        case("a.mha", meta("", zip, &zlib(&[full, b"x"].concat())), "volume-data-too-long", 0),
        case("a.mha", meta("", &size(packed.len() + 1), &packed), "volume-data-too-short", 0),
        case("a.mha", meta("", &size(9), &packed), "volume-data-too-short", 0),
        case("a.mha", meta("4 4 4", "10000 10000 10000", full), "volume-too-large", 0),
        case("a.mha", meta("4 4 4", "4 0 4", full), "volume-grid", 3),
        case("a.mha", meta("4 4 4", "4 4", full), "volume-bad-value", 3),
        case("a.mha", meta("4 4 4", "4 4 -4", full), "volume-bad-value", 3),
        case("a.mha", meta("MET_SHORT", "MET_SHIRT", full), "volume-unknown-type", 4),
        case("a.mha", meta("MET_SHORT", "int16", full), "volume-unknown-type", 4),
        case("a.mha", meta("= Image", "= Tube", full), "volume-unsupported", 1),
        case("a.mha", meta("NDims = 3", "NDims = 0", full), "volume-bad-value", 2),
        case("a.mha", meta("NDims = 3\n", "", full), "volume-missing-field", 0),
        case("a.mha", meta("", "ElementSpacing = 1 0 1\n", full), "volume-grid", 5),
        case("a.mha", meta("", "ElementSpacing = 1 nan 1\n", full), "volume-grid", 5),
        case("a.mha", meta("", "Offset = 1 inf 1\n", full), "volume-grid", 5),
        case("a.mha", meta("", "Offset = 1 2 3\nPosition = 1 2 4\n", full), "volume-bad-value", 6),
        case("a.mha", meta("", "TransformMatrix = 1 0 0 0 1 0 0 1 0\n", full), "volume-grid", 5),
        case("a.mha", meta("", "TransformMatrix = 1 0 0 0\n", full), "volume-bad-value", 5),
        case("a.mha", meta("", "CompressedData = perhaps\n", full), "volume-bad-value", 5),
        case("a.mha", meta("", "BinaryData = False\nCompressedData = True\n", full), "volume-unsupported", 0),
        case("a.mha", meta("", "HeaderSize = 5\n", full), "volume-bad-value", 0),
        case("a.mha", meta("", "HeaderSize = -7\n", full), "volume-bad-value", 5),
        case("a.mha", meta("", "ElementNumberOfChannels = 0\n", full), "volume-bad-value", 5),
        case("a.mha", meta("4 4 4\n", "4 4 2\nElementNumberOfChannels = 2\n", full), "volume-component", 3),
        case("a.mha", meta("", "no key here\n", full), "volume-header-syntax", 5),
        case("a.mha", meta("", "NDims = 3\n", full), "volume-header-syntax", 5),
    ]
}

fn check(folder: &Path, case: &Case) -> Result<(), String> {
    let path = folder.join(case.name);
    std::fs::write(&path, &case.bytes).unwrap();
    let Err(error) = load(&path, &LoadOptions::default()) else {
        return Err("was read".into());
    };
    std::fs::remove_file(&path).unwrap();
    let text = error.to_string();
    let finding = Finding::from(error.clone());
    let place = finding.place.as_ref().ok_or("has no place")?;
    if error.code() != case.code {
        return Err(format!("[{}] {text}", error.code()));
    }
    if !place.file.to_string_lossy().contains(case.names) || !text.contains(case.names) {
        return Err(format!("does not name {}: {text}", case.names));
    }
    if place.line != case.line {
        return Err(format!("line {}: {text}", place.line));
    }
    if finding.message.is_empty()
        || finding.help.is_none_or(|help| help.is_empty())
        || text.len() > 700
    {
        return Err(format!("says too little or too much: {text}"));
    }
    Ok(())
}

#[test]
fn bad_files_are_refused_with_code_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    let full: Vec<u8> = (0..64_u16).flat_map(|i| (i * 251).to_le_bytes()).collect();
    let cases: Vec<Case> = [raw_cases(&full), nrrd_cases(&full), meta_cases(&full)]
        .into_iter()
        .flatten()
        .collect();
    assert!(cases.len() > 100, "{}", cases.len());
    let failed: Vec<String> = cases
        .iter()
        .filter_map(|case| {
            let failure = check(folder.path(), case).err()?;
            let head =
                String::from_utf8_lossy(&case.bytes[..case.bytes.len().min(240)]).into_owned();
            Some(format!(
                "{} ({}): {failure}\n    {head:?}",
                case.name, case.code
            ))
        })
        .collect();
    assert!(
        failed.is_empty(),
        "{} failed:\n{}",
        failed.len(),
        failed.join("\n")
    );

    // What the cases are made from is read, and the check sees a file that is.
    for (name, bytes) in [
        ("good_4x4x4_int16.raw", full.clone()),
        ("good.nrrd", nrrd("", "", &full)),
        ("good.mha", meta("", "", &full)),
    ] {
        let good = case(name, bytes, "volume-grid", 0);
        assert_eq!(
            check(folder.path(), &good),
            Err("was read".into()),
            "{name}"
        );
    }
    let other = case("a.nrrd", nrrd("short", "shirt", &full), "volume-grid", 2);
    assert!(check(folder.path(), &other).is_err());
}
