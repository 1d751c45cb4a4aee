//! Every type, byte order and encoding, written here and read back voxel by voxel.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::path::Path;
use std::sync::{Arc, Mutex};

use common::{bzip2, gzip, hex, zlib};
use glam::{DVec3, dvec3};
use volgraph_formats::{LoadOptions, from_bytes, load};
use volgraph_volume::{Component, ScalarType, Volume, Voxels};

const DIMS: [u32; 3] = [5, 4, 3];

/// Sixty values of a type, its extremes among them, and their bytes in either order.
fn samples(ty: ScalarType, big_endian: bool) -> (Voxels, Vec<u8>, String) {
    macro_rules! of {
        ($type:ident) => {{
            let at = |i: u32| match i {
                0 => $type::MIN,
                1 => $type::MAX,
                i => ((i * 37 + 11) % 120) as $type,
            };
            let values: Vec<$type> = (0..60).map(at).collect();
            let bytes = |v: &$type| {
                if big_endian {
                    v.to_be_bytes()
                } else {
                    v.to_le_bytes()
                }
            };
            let text = values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>();
            let bytes = values.iter().flat_map(bytes).collect();
            (values.into(), bytes, text.join(" "))
        }};
    }
    match ty {
        ScalarType::U8 => of!(u8),
        ScalarType::I8 => of!(i8),
        ScalarType::U16 => of!(u16),
        ScalarType::I16 => of!(i16),
        ScalarType::U32 => of!(u32),
        ScalarType::I32 => of!(i32),
        ScalarType::U64 => of!(u64),
        ScalarType::I64 => of!(i64),
        ScalarType::F32 => of!(f32),
        ScalarType::F64 => of!(f64),
    }
}

fn read(folder: &Path, name: &str, bytes: &[u8]) -> Volume {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    let volume = load(&path, &LoadOptions::default());
    let volume = volume.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(volume.grid().dims, DIMS);
    // From memory it is the same.
    if volume.source_files().len() == 1 {
        let again = from_bytes(name, bytes, &LoadOptions::default()).unwrap();
        assert_eq!(again.digest(), volume.digest(), "{name}");
    }
    volume
}

fn nrrd(ty: ScalarType, big_endian: bool, encoding: &str, more: &str) -> Vec<u8> {
    let endian = if big_endian { "big" } else { "little" };
    format!(
        "NRRD0005\n# made here\ntype: {ty}\ndimension: 3\nsizes: 5 4 3\nendian: {endian}\nencoding: {encoding}\n\
         my key:=my value\n{more}"
    )
    .into_bytes()
}

#[test]
fn raw_files() {
    let folder = tempfile::tempdir().unwrap();
    for ty in ScalarType::ALL {
        for (big, order) in [(false, ""), (false, "_le"), (true, "_be")] {
            let (voxels, bytes, _) = samples(ty, big);
            let name = format!("a_b_5x4x3_{ty}{order}.raw");
            let volume = read(folder.path(), &name, &bytes);
            assert_eq!((volume.voxels(), volume.name()), (&voxels, "a_b"), "{name}");
            let volume = read(folder.path(), &format!("{name}.gz"), &gzip(&bytes));
            assert_eq!(volume.voxels(), &voxels, "{name}.gz");
        }
    }
    // Voxels that look like gzip and have the right length are voxels.
    let mut lookalike = samples(ScalarType::U8, false).1;
    lookalike[..3].copy_from_slice(b"\x1f\x8b\x08");
    let volume = read(folder.path(), "v_5x4x3_uint8.raw", &lookalike);
    assert_eq!(volume.voxels(), &Voxels::from(lookalike));
    // Two gzip members after each other are one stream.
    let (voxels, bytes, _) = samples(ScalarType::U16, false);
    let members = [gzip(&bytes[..50]), gzip(&bytes[50..])].concat();
    assert_eq!(
        read(folder.path(), "two_5x4x3_uint16.raw.gz", &members).voxels(),
        &voxels
    );
}

#[test]
fn nrrd_files() {
    let folder = tempfile::tempdir().unwrap();
    for ty in ScalarType::ALL {
        for big in [false, true] {
            let (voxels, bytes, text) = samples(ty, big);
            for (encoding, data) in [
                ("raw", bytes.clone()),
                ("gzip", gzip(&bytes)),
                ("gz", gzip(&bytes)),
                ("bzip2", bzip2(&bytes)),
                ("hex", hex(&bytes)),
                ("ascii", text.clone().into_bytes()),
            ] {
                let name = format!("{ty}_{big}_{encoding}");
                let attached = [nrrd(ty, big, encoding, "\n"), data.clone()].concat();
                let volume = read(folder.path(), &format!("{name}.nrrd"), &attached);
                assert_eq!(volume.voxels(), &voxels, "{name}");
                std::fs::write(folder.path().join("voxels"), &data).unwrap();
                let detached = nrrd(ty, big, encoding, "datafile: voxels\n");
                let volume = read(folder.path(), &format!("{name}.nhdr"), &detached);
                assert_eq!(volume.voxels(), &voxels, "{name}");
                assert_eq!(volume.source_files().len(), 2);
            }
        }
    }
}

#[test]
fn a_line_end_behind_the_data_is_no_data() {
    let (voxels, bytes, _) = samples(ScalarType::I16, false);
    for end in ["\n", "\r\n"] {
        let file = [
            &nrrd(ScalarType::I16, false, "raw", "\n")[..],
            &bytes,
            end.as_bytes(),
        ]
        .concat();
        let volume = from_bytes("a.nrrd", &file, &LoadOptions::default()).unwrap();
        assert_eq!(volume.voxels(), &voxels);
    }
    for more in ["\n\n", "x", "\n\r\n"] {
        let file = [
            &nrrd(ScalarType::I16, false, "raw", "\n")[..],
            &bytes,
            more.as_bytes(),
        ]
        .concat();
        let error = from_bytes("a.nrrd", &file, &LoadOptions::default()).unwrap_err();
        assert_eq!(error.code(), "volume-data-too-long");
    }
}

#[test]
fn metaimage_files() {
    let folder = tempfile::tempdir().unwrap();
    let name_of = |ty| match ty {
        ScalarType::U8 => "MET_UCHAR",
        ScalarType::I8 => "MET_CHAR",
        ScalarType::U16 => "MET_USHORT",
        ScalarType::I16 => "MET_SHORT",
        ScalarType::U32 => "MET_UINT",
        ScalarType::I32 => "MET_INT",
        ScalarType::U64 => "MET_ULONG_LONG",
        ScalarType::I64 => "MET_LONG_LONG",
        ScalarType::F32 => "MET_FLOAT",
        ScalarType::F64 => "MET_DOUBLE",
    };
    for ty in ScalarType::ALL {
        for big in [false, true] {
            let (voxels, bytes, text) = samples(ty, big);
            let packed = zlib(&bytes);
            let size = format!(
                "CompressedData = True\nCompressedDataSize = {}",
                packed.len()
            );
            for (encoding, data) in [
                ("CompressedData = False", bytes.clone()),
                ("CompressedData = True", packed.clone()),
                (size.as_str(), packed.clone()),
                ("BinaryData = False", text.clone().into_bytes()),
            ] {
                let header = format!(
                    "ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nBinaryDataByteOrderMSB = {big}\n{encoding}\n\
                     ElementType = {}\nElementDataFile = ",
                    name_of(ty)
                );
                let local = [header.as_bytes(), b"LOCAL\n", &data].concat();
                let volume = read(folder.path(), "local.mha", &local);
                assert_eq!(volume.voxels(), &voxels, "{header}");
                std::fs::write(folder.path().join("voxels"), &data).unwrap();
                let detached = format!("{header}voxels\n");
                let volume = read(folder.path(), "detached.mhd", detached.as_bytes());
                assert_eq!(volume.voxels(), &voxels, "{header}");
            }
        }
    }
}

#[test]
fn lists_series_and_skips() {
    let folder = tempfile::tempdir().unwrap();
    let (voxels, bytes, _) = samples(ScalarType::I16, false);
    for (z, slice) in bytes.chunks(40).enumerate() {
        std::fs::write(folder.path().join(format!("s{z:02}.raw")), slice).unwrap();
        std::fs::write(folder.path().join(format!("s{z:02}.raw.gz")), gzip(slice)).unwrap();
        let padded = [b"one\ntwo\nxyz", slice, b"tail"].concat();
        std::fs::write(folder.path().join(format!("padded{z}.raw")), padded).unwrap();
    }
    let ty = ScalarType::I16;
    let meta = "ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementType = MET_SHORT\nElementDataFile = ";
    for (name, header) in [
        (
            "list.nhdr",
            nrrd(
                ty,
                false,
                "raw",
                "data file: LIST\ns00.raw\ns01.raw\ns02.raw\n",
            ),
        ),
        (
            "list2.nhdr",
            nrrd(
                ty,
                false,
                "gzip",
                "data file: LIST 2\ns00.raw.gz\ns01.raw.gz\ns02.raw.gz\n\n",
            ),
        ),
        (
            "series.nhdr",
            nrrd(ty, false, "raw", "data file: s%02d.raw 0 2 1\n"),
        ),
        (
            "skip.nhdr",
            nrrd(
                ty,
                false,
                "raw",
                "line skip: 2\nbyte skip: -5\ndata file: padded%d.raw 0 2 1\n",
            ),
        ),
        (
            "list.mhd",
            format!("{meta}LIST\ns00.raw\ns01.raw\ns02.raw\n").into_bytes(),
        ),
        (
            "series.mhd",
            format!("{meta}s%02d.raw 0 2 1\n").into_bytes(),
        ),
    ] {
        let volume = read(folder.path(), name, &header);
        assert_eq!(volume.voxels(), &voxels, "{name}");
        assert_eq!(volume.source_files().len(), 4, "{name}");
    }
    let padded = [b"12345".as_slice(), &bytes].concat();
    std::fs::write(folder.path().join("head5"), &padded).unwrap();
    std::fs::write(folder.path().join("head5.gz"), gzip(&padded)).unwrap();
    for (name, header) in [
        (
            "skip5.nhdr",
            nrrd(ty, false, "raw", "byte skip: 5\ndata file: head5\n"),
        ),
        (
            "last.nhdr",
            nrrd(ty, false, "raw", "byteskip: -1\ndata file: head5\n"),
        ),
        (
            "gz5.nhdr",
            nrrd(ty, false, "gzip", "byte skip: 5\ndata file: head5.gz\n"),
        ),
        (
            "gzlast.nhdr",
            nrrd(ty, false, "gzip", "byte skip: -1\ndata file: head5.gz\n"),
        ),
        (
            "skip5.mhd",
            format!("HeaderSize = 5\n{meta}head5\n")
                .replacen(
                    "HeaderSize = 5\nObjectType = Image\n",
                    "ObjectType = Image\nHeaderSize = 5\n",
                    1,
                )
                .into_bytes(),
        ),
        (
            "last.mhd",
            format!("{meta}head5\n")
                .replacen("NDims", "HeaderSize = -1\nNDims", 1)
                .into_bytes(),
        ),
    ] {
        assert_eq!(
            read(folder.path(), name, &header).voxels(),
            &voxels,
            "{name}"
        );
    }
}

#[test]
fn options_place_choose_and_report() {
    let folder = tempfile::tempdir().unwrap();
    let (voxels, bytes, _) = samples(ScalarType::U16, true);
    let path = folder.path().join("anything");
    std::fs::write(&path, &bytes).unwrap();
    let seen = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&seen);
    let options = LoadOptions {
        dims: Some([2, 5, 6]),
        scalar_type: Some(ScalarType::U16),
        big_endian: true,
        spacing: Some(dvec3(1.0, 2.0, 3.0)),
        origin: Some(dvec3(-1.0, 0.0, 9.0)),
        node_centred: true,
        progress: Some(Arc::new(move |done, total| {
            sink.lock().unwrap().push((done, total));
        })),
        ..LoadOptions::default()
    };
    let volume = load(&path, &options).unwrap();
    assert_eq!((volume.voxels(), volume.grid().dims), (&voxels, [2, 5, 6]));
    assert_eq!(volume.grid().spacing(), dvec3(1.0, 2.0, 3.0));
    assert_eq!(volume.grid().origin(), dvec3(-1.0, 0.0, 9.0));
    assert_eq!(
        volume.grid().box_index(),
        (DVec3::ZERO, dvec3(1.0, 4.0, 5.0))
    );
    assert_eq!(seen.lock().unwrap().last(), Some(&(120, 120)));

    // An RGB file: three values per voxel, one named.
    let rgb: Vec<u8> = (0..24).collect();
    let header = b"NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 2 2 2\nkinds: RGB-color domain domain domain\nencoding: raw\n\n";
    let bytes = [&header[..], &rgb].concat();
    let options = LoadOptions {
        component: Some(Component::Index(2)),
        ..LoadOptions::default()
    };
    let green = from_bytes("rgb.nrrd", &bytes, &options).unwrap();
    let want: Vec<u8> = (0..8).map(|i| i * 3 + 2).collect();
    assert_eq!(green.voxels(), &Voxels::from(want));

    // Without a choice the file's word holds: colours.
    let colors = from_bytes("rgb.nrrd", &bytes, &LoadOptions::default()).unwrap();
    assert_eq!(colors.colors().unwrap()[1], [3, 4, 5, 255]);
    assert_eq!(colors.about().picked.unwrap().component, Component::Color);
    assert_ne!(colors.digest(), green.digest());
}

#[test]
fn what_the_reader_guesses_it_says() {
    let load = |more: &str| {
        let header =
            format!("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 2\nencoding: raw\n{more}\n");
        from_bytes(
            "w.nrrd",
            &[header.as_bytes(), b"ab"].concat(),
            &LoadOptions::default(),
        )
        .unwrap()
    };
    for (more, word) in [
        ("spacngs: 1 1 1\n", "did you mean `spacings`"),
        (
            "space directions: (1,0,0) (0,1,0) (0,0,1)\n",
            "left-posterior-superior",
        ),
        ("spacings: 1 1 nan\nthicknesses: nan nan 2\n", "thickness"),
        ("centers: cell cell node\n", "node-centred"),
    ] {
        let volume = load(more);
        assert_eq!(
            volume.warnings().len(),
            1,
            "{more}: {:?}",
            volume.warnings()
        );
        let warning = &volume.warnings()[0];
        assert!(
            warning.starts_with("w.nrrd: line 6") && warning.contains(word),
            "{warning}"
        );
    }
    assert!(
        load("content: any\nspace units: \"mm\"\n")
            .warnings()
            .is_empty()
    );
    assert!(load("centers: node node node\n").grid().node_centred);
    assert_eq!(
        load("axis mins: 0 0 0\naxis maxs: 1 1 8\n")
            .grid()
            .spacing(),
        dvec3(1.0, 1.0, 4.0)
    );
    let meta = "ObjectType = Image\nNDims = 3\nDimSize = 1 1 2\nElementSpacng = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\nab";
    let volume = from_bytes("w.mha", meta.as_bytes(), &LoadOptions::default()).unwrap();
    assert!(
        volume.warnings()[0].contains("did you mean `ElementSpacing`"),
        "{:?}",
        volume.warnings()
    );
}
