//! Files of the kind that fuzzing found: each made a reader panic, hang or take memory by a header's word.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::path::Path;

use volgraph_formats::{LoadOptions, from_bytes, load};

fn beside(path: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(path);
    std::fs::read(path).unwrap()
}

/// The decoder makes all components that a code stream promises, each as large as the picture.
#[test]
fn a_frame_of_too_many_components_is_not_decoded() {
    let mut bytes = beside("dicom/jpeg_2000.dcm");
    let siz = bytes
        .windows(4)
        .position(|four| four == [0xff, 0x4f, 0xff, 0x51])
        .unwrap();
    bytes[siz + 40..siz + 42].copy_from_slice(&[0x2a, 0xaa]);
    let error = from_bytes("a.dcm", &bytes, &LoadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "volume-data-corrupt", "{error}");
    assert!(error.to_string().contains("10922 components"), "{error}");
}

/// Every frame has a fragment at least: a number alone would make a million entries.
#[test]
fn more_frames_than_fragments_are_refused() {
    let frames = b"\x28\0\x08\0IS\x06\x00900000";
    let mut bytes = beside("dicom/rle.dcm");
    let rows = bytes
        .windows(4)
        .position(|four| four == [0x28, 0, 0x10, 0])
        .unwrap();
    for (tag, at) in [(0x10, rows), (0x11, rows + 10)] {
        assert_eq!(bytes[at..at + 4], [0x28, 0, tag, 0]);
        bytes[at + 8..at + 10].copy_from_slice(&[1, 0]);
    }
    bytes.splice(rows..rows, frames.iter().copied());
    let error = from_bytes("a.dcm", &bytes, &LoadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "volume-data-too-short", "{error}");
    assert!(error.to_string().contains("900000"), "{error}");
}

/// Frames of a bit take less in the file than in memory.
#[test]
fn frames_of_next_to_nothing_are_refused() {
    let mut bytes = beside("dicom/mono1.dcm");
    let at = |bytes: &[u8], tag: [u8; 2]| {
        let tag = [tag[0], 0, tag[1], 0];
        bytes.windows(4).position(|four| four == tag).unwrap()
    };
    for (tag, value) in [([0x28, 0x10], 1), ([0x28, 0x11], 1)] {
        let at = at(&bytes, tag);
        bytes[at + 8] = value;
    }
    let pixels = bytes
        .windows(4)
        .position(|four| four == [0xe0, 0x7f, 0x10, 0]);
    let pixels = pixels.unwrap();
    bytes.truncate(pixels + 8);
    bytes.extend(40_000_u32.to_le_bytes());
    bytes.extend([0; 40_000]);
    let rows = at(&bytes, [0x28, 0x10]);
    bytes.splice(rows..rows, b"\x28\0\x08\0IS\x06\x0020000 ".iter().copied());
    let error = from_bytes("a.dcm", &bytes, &LoadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "volume-too-large", "{error}");
}

/// Metadata of some bytes is no reason to fill a GiB with the fill value.
#[test]
fn an_array_without_chunks_is_not_filled() {
    let folder = tempfile::tempdir().unwrap();
    let write = |shape: [u32; 3]| {
        let metadata = serde_json::json!({
            "zarr_format": 3, "node_type": "array", "shape": shape, "data_type": "uint8",
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": shape}},
            "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
            "fill_value": 7, "codecs": [{"name": "bytes"}, {"name": "gzip", "configuration": {"level": 1}}],
        });
        std::fs::write(folder.path().join("zarr.json"), metadata.to_string()).unwrap();
    };
    write([64, 4096, 4096]);
    let error = load(folder.path(), &LoadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "volume-data-too-short", "{error}");
    // A small one may be empty.
    write([64, 64, 64]);
    let volume = load(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(volume.statistics().max, 7.0);
}

/// Pixels in floats have no bits beside them, whatever `BitsStored` and `HighBit` say.
#[test]
fn stored_bits_of_floats_do_not_matter() {
    let mut bytes = beside("dicom/bits_beside.dcm");
    let at = |bytes: &[u8], tag: [u8; 4]| bytes.windows(4).position(|four| four == tag).unwrap();
    let stored = at(&bytes, [0x28, 0, 1, 1]);
    bytes[stored + 8] = 33;
    let high = at(&bytes, [0x28, 0, 2, 1]);
    bytes[high + 8] = 0;
    let pixels = at(&bytes, [0xe0, 0x7f, 0x10, 0]);
    bytes.truncate(pixels);
    let voxels: Vec<u8> = (0..64_u8)
        .flat_map(|i| f32::from(i).to_le_bytes())
        .collect();
    bytes.extend(b"\xe0\x7f\x08\0OF\0\0\0\x01\0\0");
    bytes.extend(voxels);
    let volume = from_bytes("a.dcm", &bytes, &LoadOptions::default()).unwrap();
    assert_eq!(volume.statistics().max, 63.0);
}
