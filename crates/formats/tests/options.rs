//! What is no file, options that contradict, and streams without end.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::path::Path;

use common::gzip;
use glam::DVec3;
use volgraph_formats::{LoadOptions, from_bytes, load};
use volgraph_volume::{Component, ScalarType};

/// 4×4×4 int16, with the encoding and whatever lines follow it.
fn nrrd(encoding: &str, data: &[u8]) -> Vec<u8> {
    let header = format!(
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 4 4\nendian: little\nencoding: {encoding}\n\n"
    );
    [header.as_bytes(), data].concat()
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refuse = |path: &Path| load(path, &LoadOptions::default()).unwrap_err();
    for path in [
        folder.path(),
        &folder.path().join("gone.nrrd"),
        Path::new(""),
    ] {
        let error = refuse(path);
        assert_eq!(error.code(), "volume-unreadable");
        assert!(
            error.to_string().contains(&path.display().to_string()),
            "{error}"
        );
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // A device never ends, and a socket or a pipe may never begin.
        assert_eq!(refuse(Path::new("/dev/zero")).code(), "volume-unreadable");
        let locked = folder.path().join("locked.nrrd");
        std::fs::write(&locked, nrrd("raw", &[0; 128])).unwrap();
        std::fs::set_permissions(&locked, PermissionsExt::from_mode(0o000)).unwrap();
        // The superuser may read it all the same.
        if std::fs::read(&locked).is_err() {
            assert_eq!(refuse(&locked).code(), "volume-unreadable");
        }
    }
}

#[test]
fn options_that_contradict_are_refused() {
    let full = vec![0; 128];
    let with = |name: &str, bytes: &[u8], options: LoadOptions| {
        let error = from_bytes(name, bytes, &options).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        error.code()
    };
    let base = LoadOptions::default;
    let header = nrrd("raw", &full);
    let raw = "a_4x4x4_int16_le.raw";
    for (name, bytes, options, code) in [
        (
            "a.nrrd",
            &header,
            LoadOptions {
                dims: Some([4, 4, 2]),
                ..base()
            },
            "volume-option",
        ),
        (
            "a.nrrd",
            &header,
            LoadOptions {
                scalar_type: Some(ScalarType::U16),
                ..base()
            },
            "volume-option",
        ),
        (
            "a.nrrd",
            &header,
            LoadOptions {
                spacing: Some(DVec3::new(1.0, 0.0, 1.0)),
                ..base()
            },
            "volume-option",
        ),
        (
            "a.nrrd",
            &header,
            LoadOptions {
                spacing: Some(DVec3::NAN),
                ..base()
            },
            "volume-option",
        ),
        (
            "a.nrrd",
            &header,
            LoadOptions {
                origin: Some(DVec3::INFINITY),
                ..base()
            },
            "volume-grid",
        ),
        (
            "a.nrrd",
            &header,
            LoadOptions {
                component: Some(Component::Index(1)),
                ..base()
            },
            "volume-component",
        ),
        (
            "a.nrrd",
            &header,
            LoadOptions {
                max_bytes: Some(127),
                ..base()
            },
            "volume-too-large",
        ),
        (
            raw,
            &full,
            LoadOptions {
                big_endian: true,
                ..base()
            },
            "volume-option",
        ),
        (
            raw,
            &full,
            LoadOptions {
                dims: Some([4, 4, 5]),
                ..base()
            },
            "volume-data-too-short",
        ),
        (
            raw,
            &full,
            LoadOptions {
                component: Some(Component::Index(1)),
                ..base()
            },
            "volume-component",
        ),
    ] {
        assert_eq!(with(name, bytes, options.clone()), code, "{options:?}");
    }
    let detached = nrrd("raw\ndata file: a.raw", b"");
    assert_eq!(with("a.nhdr", &detached, base()), "volume-data-file");
    let agree = LoadOptions {
        dims: Some([4; 3]),
        scalar_type: Some(ScalarType::I16),
        max_bytes: Some(128),
        ..base()
    };
    assert!(from_bytes("a.nrrd", &header, &agree).is_ok());
}

#[test]
fn a_stream_that_never_ends_stops_at_the_limit() {
    // 64 MiB of zeros in 64 KiB of gzip, of which the header wants the last 128 bytes.
    let bomb = gzip(&vec![0; 64 << 20]);
    let bytes = nrrd("gzip\nbyte skip: -1", &bomb);
    let options = LoadOptions {
        max_bytes: Some(1 << 20),
        ..LoadOptions::default()
    };
    assert_eq!(
        from_bytes("a.nrrd", &bytes, &options).unwrap_err().code(),
        "volume-too-large"
    );
    assert!(from_bytes("a.nrrd", &bytes, &LoadOptions::default()).is_ok());
}
