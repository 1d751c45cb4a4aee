//! Whatever the bytes are: a volume or an error that says something, never a panic.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::{gzip, zlib};
use proptest::prelude::*;
use volgraph_formats::{LoadOptions, from_bytes, metaimage, nrrd, parse_raw_name};
use volgraph_volume::Component;

/// Small enough that a header's word cannot make a test slow.
fn options(component: Option<u32>) -> LoadOptions {
    LoadOptions {
        max_bytes: Some(1 << 16),
        component: component.map(Component::Index),
        ..LoadOptions::default()
    }
}

/// Reads the bytes under several names; whatever is read must be whole.
fn read(bytes: &[u8]) {
    for (name, component) in [
        ("a.nrrd", None),
        ("a.mha", Some(1)),
        ("a_2x2x2_uint8.raw.gz", None),
        ("a", Some(0)),
    ] {
        match from_bytes(name, bytes, &options(component)) {
            Ok(volume) => {
                assert_eq!(volume.voxels().len() as u64, volume.grid().voxel_count());
                assert!(volume.grid().check().is_ok());
                let (lo, hi) = volume.grid().box_index();
                let _ = (volume.trilinear(lo), volume.trilinear(hi), volume.digest());
                let _ = volume.statistics().percentile(50.0);
            }
            Err(error) => {
                assert!(error.to_string().contains(name));
                assert!(!error.trouble().remedy.is_empty());
            }
        }
    }
}

fn headers() -> Vec<Vec<u8>> {
    let data: Vec<u8> = (0..48).collect();
    let text: Vec<u8> = (0..24).flat_map(|i| format!("{i} ").into_bytes()).collect();
    let near = "NRRD0004\n# c\ntype: int16\ndimension: 3\nsizes: 2 3 4\nendian: little\n";
    let space = "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,2)\nspace origin: (1,2,3)\nkinds: domain domain domain\n";
    let scalar = "spacings: 1 2 3\nthicknesses: 1 1 1\naxis mins: 0 0 0\naxis maxs: 2 3 4\ncenters: node node node\na:=b\n";
    let meta = "ObjectType = Image\nNDims = 3\nDimSize = 2 3 4\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\n\
                ElementSpacing = 1 2 3\nElementType = MET_SHORT\nHeaderSize = 0\nElementNumberOfChannels = 1\n";
    let join = |parts: &[&str], data: &[u8]| [parts.concat().as_bytes(), data].concat();
    vec![
        join(&[near, space, "encoding: raw\n\n"], &data),
        join(
            &[
                near,
                scalar,
                "encoding: gzip\nbyte skip: 0\nline skip: 0\n\n",
            ],
            &gzip(&data),
        ),
        join(&[near, "encoding: ascii\n\n"], &text),
        join(
            &[
                near,
                "encoding: raw\nbyte skip: -1\ndata file: LIST 2\na.raw\nb.raw\n\n",
            ],
            b"",
        ),
        join(
            &[near, "encoding: hex\ndata file: a%03d.raw 1 4 1\n\n"],
            b"",
        ),
        join(&[meta, "ElementDataFile = LOCAL\n"], &data),
        join(
            &[
                meta,
                "CompressedData = True\nCompressedDataSize = 0\nElementDataFile = LOCAL\n",
            ],
            &zlib(&data),
        ),
        join(
            &[meta, "BinaryData = False\nElementDataFile = LOCAL\n"],
            &text,
        ),
        join(&[meta, "ElementDataFile = LIST\na.raw\nb.raw\n"], b""),
    ]
}

/// One change: a byte, a cut, a piece repeated, a number replaced by a nasty one.
#[derive(Clone, Debug)]
enum Change {
    Byte(usize, u8),
    Cut(usize, usize),
    Repeat(usize, usize),
    Number(usize, &'static str),
}

fn change() -> impl Strategy<Value = Change> {
    let nasty = prop::sample::select(vec![
        "0",
        "-1",
        "-9223372036854775808",
        "18446744073709551615",
        "18446744073709551616",
        "1e999",
        "nan",
        "-inf",
        "1e-320",
        "",
        "(",
        "none",
        "%d",
        "0x10",
        "4294967296",
        "1000000000000",
    ]);
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(at, byte)| Change::Byte(at, byte)),
        (any::<usize>(), 0..40_usize).prop_map(|(at, len)| Change::Cut(at, len)),
        (any::<usize>(), 0..40_usize).prop_map(|(at, len)| Change::Repeat(at, len)),
        (any::<usize>(), nasty).prop_map(|(at, number)| Change::Number(at, number)),
    ]
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    if bytes.is_empty() {
        return;
    }
    let len = bytes.len();
    match *change {
        Change::Byte(at, byte) => bytes[at % len] = byte,
        Change::Cut(at, count) => {
            bytes.drain(at % len..(at % len + count).min(len));
        }
        Change::Repeat(at, count) => {
            let piece = bytes[at % len..(at % len + count).min(len)].to_vec();
            bytes.splice(at % len..at % len, piece);
        }
        Change::Number(at, text) => {
            let starts = (0..len).filter(|&i| bytes[i].is_ascii_digit());
            let starts: Vec<usize> = starts
                .filter(|&i| i == 0 || !bytes[i - 1].is_ascii_digit())
                .collect();
            if let Some(&start) = starts.get(at % starts.len().max(1)) {
                let digits = bytes[start..]
                    .iter()
                    .take_while(|byte| byte.is_ascii_digit())
                    .count();
                bytes.splice(start..start + digits, text.bytes());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_name(name in "\\PC*") {
        let _ = parse_raw_name(&name);
    }

    #[test]
    fn names_like_raw_names(name in "[a-z_.x0-9/é]{0,12}_?[0-9]{0,11}[xX][0-9+-]{0,11}x[0-9]{0,3}_?(uint8|int16|f3é)?(_be|_le)?(.raw|.RAW)?(.gz)?") {
        if let Ok(raw) = parse_raw_name(&name) {
            let [x, y, z] = raw.dims;
            let again = format!("{}_{x}x{y}x{z}_{}.raw", raw.name, raw.scalar_type);
            let again = parse_raw_name(&again).unwrap();
            prop_assert_eq!((again.dims, again.scalar_type), (raw.dims, raw.scalar_type));
        }
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300), magic in 0..4_usize) {
        let start: &[u8] = [&b""[..], b"NRRD0004\n", b"ObjectType = Image\n", b"\x1f\x8b\x08\0"][magic];
        let bytes = [start, &bytes].concat();
        let _ = nrrd::parse_header(&bytes);
        let _ = metaimage::parse_header(&bytes);
        read(&bytes);
    }

    #[test]
    fn headers_with_changes(which in 0..9_usize, changes in prop::collection::vec(change(), 0..5)) {
        let mut bytes = headers().swap_remove(which);
        for change in &changes {
            apply(&mut bytes, change);
        }
        let _ = nrrd::parse_header(&bytes);
        let _ = metaimage::parse_header(&bytes);
        read(&bytes);
    }
}

#[test]
fn the_unchanged_headers_are_good() {
    let good = headers()
        .iter()
        .filter(|bytes| from_bytes("a", bytes, &options(None)).is_ok())
        .count();
    // All but the three whose data is in other files.
    assert_eq!(good, 6);
}

#[test]
fn a_header_of_nothing_but_keys_is_read_in_time() {
    let keys = |separator: &str| {
        (0..300_000)
            .map(|i| format!("k{i}{separator}v\n"))
            .collect::<String>()
    };
    let near = format!("NRRD0004\n{}\n", keys(": "));
    assert!(nrrd::parse_header(near.as_bytes()).is_err());
    let meta = format!("ObjectType = Image\n{}", keys(" = "));
    assert!(metaimage::parse_header(meta.as_bytes()).is_err());
}
