//! Zarr folders that are broken on purpose: a volume or an error that says something, never a panic.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::fs;

use common::zarr::one;
use common::{table, unhex};
use volgraph_formats::{LoadOptions, load};
use volgraph_volume::{Component, Volume, VolumeError};

/// The outcome with one file's text changed.
fn forged(
    case: &str,
    file: &str,
    change: impl Fn(String) -> String,
) -> Result<Volume, VolumeError> {
    let (_folder, path) = one(case);
    let file = path.join(file);
    let old = fs::read_to_string(&file).unwrap();
    let new = change(old.clone());
    assert_ne!(old, new, "{case}");
    fs::write(&file, new).unwrap();
    load(
        &path,
        &LoadOptions {
            component: Some(Component::Index(0)),
            ..LoadOptions::default()
        },
    )
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
        (
            "v3_int16",
            "zarr.json",
            "/shape",
            json!([huge, huge, huge]),
            "volume-too-large",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/shape",
            json!([0, 6, 7]),
            "volume-grid",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/shape",
            json!([1 << 20, 1 << 20, 1]),
            "volume-too-large",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/chunk_grid/configuration/chunk_shape",
            json!([huge, huge, huge]),
            "volume-too-large",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/chunk_grid/configuration/chunk_shape",
            json!([1 << 20, 64, 3]),
            "volume-data-corrupt",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/chunk_grid/configuration/chunk_shape",
            json!([0, 1, 1]),
            "volume-bad-value",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/chunk_grid/configuration/chunk_shape",
            json!([1, 1]),
            "volume-bad-value",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/chunk_grid/name",
            json!("rectilinear"),
            "volume-unsupported",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/data_type",
            json!("int24"),
            "volume-unknown-type",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/fill_value",
            json!(70000),
            "volume-bad-value",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/codecs/0/name",
            json!("packbits"),
            "volume-unsupported",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/codecs",
            json!([]),
            "volume-unsupported",
        ),
        (
            "v3_int16",
            "zarr.json",
            "/codecs/1/name",
            json!("gzip"),
            "volume-data-corrupt",
        ),
        (
            "v3_transposed",
            "zarr.json",
            "/codecs/0/configuration/order",
            json!([0, 0, 1]),
            "volume-bad-value",
        ),
        (
            "v3_sharded",
            "zarr.json",
            "/codecs/0/configuration/chunk_shape",
            json!([3, 4, 3]),
            "volume-bad-value",
        ),
        (
            "v3_sharded",
            "zarr.json",
            "/codecs/0/configuration/chunk_shape",
            json!([1, 1, 1]),
            "volume-data-corrupt",
        ),
        (
            "v2_zstd",
            ".zarray",
            "/filters",
            json!([{"id": "delta"}]),
            "volume-unsupported",
        ),
        (
            "v2_zstd",
            ".zarray",
            "/dtype",
            json!("<c8"),
            "volume-unknown-type",
        ),
        (
            "v2_zstd",
            ".zarray",
            "/dtype",
            json!("é"),
            "volume-unknown-type",
        ),
        (
            "v2_zstd",
            ".zarray",
            "/compressor/id",
            json!("lzma"),
            "volume-unsupported",
        ),
        (
            "ome_0_5",
            "zarr.json",
            "/attributes/ome/multiscales/0/datasets/0/path",
            json!("../0"),
            "volume-bad-value",
        ),
        (
            "ome_0_5",
            "zarr.json",
            "/attributes/ome/multiscales/0/datasets/0/path",
            json!("9"),
            "volume-data-file",
        ),
        (
            "ome_0_5",
            "zarr.json",
            "/attributes/ome/multiscales/0/datasets",
            json!([]),
            "volume-bad-value",
        ),
        (
            "ome_0_5",
            "zarr.json",
            "/attributes/ome/multiscales/0/axes",
            json!(["z", "y", "x"]),
            "volume-bad-value",
        ),
        (
            "ome_0_5",
            "zarr.json",
            "/attributes/ome/multiscales/0/coordinateTransformations/0/scale",
            json!([1, 1, 0, 1, 1]),
            "volume-grid",
        ),
        (
            "ome_0_5",
            "zarr.json",
            "/attributes/ome/multiscales/0/coordinateTransformations/0/type",
            json!("affine"),
            "volume-unsupported",
        ),
    ] {
        let error = forged(case, file, |text| set(&text, pointer, value.clone())).unwrap_err();
        assert_eq!(error.code(), code, "{case} {pointer} {value}: {error}");
        assert!(error.to_string().contains(case) && !error.trouble().remedy.is_empty());
    }
    let error = forged("v3_int16", "zarr.json", |text| {
        text[..text.len() / 2].to_owned()
    })
    .unwrap_err();
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
        (
            "v2_zstd",
            "0.0.0",
            [
                &b"\x28\xb5\x2f\xfd\xe0"[..],
                &(1_u64 << 60).to_le_bytes(),
                b"\x01\0\0",
            ]
            .concat(),
        ),
        (
            "v2_blosc_lz4_1",
            "0.0.0",
            [&b"\x02\x01\x21\x04"[..], &[0xff; 8], &16_u32.to_le_bytes()].concat(),
        ),
    ] {
        let (_folder, path) = one(case);
        assert!(path.join(file).is_file(), "{case}");
        let bomb_len = bomb.len();
        fs::write(path.join(file), bomb).unwrap();
        let error = load(&path, &LoadOptions::default()).unwrap_err();
        assert_eq!(error.code(), "volume-data-corrupt", "{case}: {error}");
        // Stopped at the size of the chunk, and not measured at the end.
        if bomb_len > 1000 {
            assert!(error.trouble().cause.contains("holds more than"), "{error}");
        }
    }
}

#[test]
fn too_many_chunks_are_refused_before_they_are_looked_for() {
    let error = forged("v3_holes", "zarr.json", |text| {
        let text = set(&text, "/shape", serde_json::json!([1000, 1000, 1000]));
        set(
            &text,
            "/chunk_grid/configuration/chunk_shape",
            serde_json::json!([1, 1, 1]),
        )
    });
    assert_eq!(error.unwrap_err().code(), "volume-too-large");
}

#[test]
fn an_array_that_is_not_read_does_not_spoil_its_neighbours() {
    let (_folder, path) = one("group");
    fs::create_dir(path.join("names")).unwrap();
    let good = fs::read_to_string(path.join("density/zarr.json")).unwrap();
    fs::write(
        path.join("names/zarr.json"),
        set(&good, "/data_type", "string".into()),
    )
    .unwrap();
    let part = |name: &str| LoadOptions {
        part: Some(name.to_owned()),
        ..LoadOptions::default()
    };
    assert!(load(&path, &part("density")).is_ok());
    let error = load(&path, &part("names")).unwrap_err();
    assert_eq!(error.code(), "volume-unknown-type");
    assert!(error.to_string().contains("names"));
}

#[test]
fn a_wrong_checksum_is_seen() {
    let (_folder, path) = one("v3_gzip_crc");
    let file = path.join("c/0/0/0");
    let mut bytes = fs::read(&file).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(file, bytes).unwrap();
    let error = load(&path, &LoadOptions::default()).unwrap_err();
    assert!(error.trouble().cause.contains("checksum"), "{error}");
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
    let nasty = [
        "0",
        "-1",
        "1e999",
        "18446744073709551615",
        "4294967296",
        "null",
        "\"\"",
        "[]",
        "1000000",
    ];
    let mut random = Random(88_172_645_463_325_252);
    let cases: Vec<&str> = {
        let mut cases: Vec<&str> = table(common::zarr::FILES)
            .iter()
            .map(|row| row["case"])
            .collect();
        cases.dedup();
        cases
    };
    let (mut read, mut refused) = (0, 0);
    for case in cases {
        let (_folder, path) = one(case);
        let rows = table(common::zarr::FILES);
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
                        let starts: Vec<usize> = (0..bytes.len())
                            .filter(|&i| bytes[i].is_ascii_digit())
                            .collect();
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
