//! Tiny files in each format, good ones and bad ones.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::files::*;
use glam::DVec3;
use volgraph_mesh::{Mesh, ReadOptions};

fn is_the_box(mesh: &Mesh) {
    let report = mesh.report();
    assert_eq!((report.vertices, report.triangles), (8, 12), "{report}");
    assert!(report.is_watertight() && report.is_oriented(), "{report}");
    assert_eq!(report.signed_volume, 8.0, "{report}");
    let middle = DVec3::new(0.25, 0.0, 8.0);
    assert_eq!(report.bounds, (middle - HALF, middle + HALF), "{report}");
    assert!(mesh.warnings().is_empty());
}

#[test]
fn each_format_gives_the_box() {
    for (name, format, bytes) in files() {
        let mesh = read(name, &bytes).unwrap();
        is_the_box(&mesh);
        assert_eq!(mesh.format(), format);
        assert_eq!(mesh.name(), &name[..1]);
        // The content tells, whatever the name; and gzip is seen through.
        is_the_box(&read("noname", &bytes).unwrap());
        is_the_box(&read(&format!("{name}.gz"), &gzip(&bytes)).unwrap());
        // From disk.
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, &bytes).unwrap();
        let mesh = Mesh::read(&path, &ReadOptions::default()).unwrap();
        is_the_box(&mesh);
        assert_eq!(mesh.source_files(), [path]);
    }
}

#[test]
fn bad_files_are_refused_with_line_and_reason() {
    let cut = |bytes: Vec<u8>, end: usize| bytes[..bytes.len() - end].to_vec();
    let (o, p, l) = (obj(), ply_text(), ply_binary(false));
    let cases: Vec<(&str, Vec<u8>, &str, u32)> = vec![
        ("a.obj", b"".to_vec(), "mesh-empty", 0),
        ("a.stl", b"".to_vec(), "mesh-unknown-format", 0),
        ("a.stl", vec![7; 500], "mesh-too-short", 0),
        ("a.ply", b"nothing".to_vec(), "mesh-unknown-format", 0),
        ("a.png", b"\x89PNG".to_vec(), "mesh-unknown-format", 0),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_vec(),
            "mesh-empty",
            0,
        ),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_vec(),
            "mesh-empty",
            0,
        ),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\nf 1 2 3\n".to_vec(),
            "mesh-index",
            5,
        ),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n".to_vec(),
            "mesh-index",
            4,
        ),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n".to_vec(),
            "mesh-index",
            4,
        ),
        (
            "a.obj",
            b"v 0 0 0\nf 1 2 99999999999\n".to_vec(),
            "mesh-index",
            2,
        ),
        (
            "a.obj",
            b"v 0 0 0\nf 1 2 -9223372036854775808\n".to_vec(),
            "mesh-index",
            2,
        ),
        ("a.obj", b"v 0 0\n".to_vec(), "mesh-syntax", 1),
        ("a.obj", b"v 0 0 1e999\n".to_vec(), "mesh-bad-value", 1),
        ("a.obj", b"v 0 0 zero\n".to_vec(), "mesh-bad-value", 1),
        ("a.obj", b"v 0 0 0\nf 1 1\n".to_vec(), "mesh-syntax", 2),
        (
            "a.obj",
            b"v 0 0 0\nf 1 a/b 1\n".to_vec(),
            "mesh-bad-value",
            2,
        ),
        ("a.obj", b"v 0 0 \xff\n".to_vec(), "mesh-syntax", 1),
        ("a.obj", replaced(&o, "f 1/1", "f /1"), "mesh-bad-value", 36),
        (
            "a.ply",
            replaced(&p, "format ascii", "format text"),
            "mesh-syntax",
            2,
        ),
        ("a.ply", replaced(&p, "end_header\n", ""), "mesh-syntax", 14),
        (
            "a.ply",
            replaced(&p, "property float z\n", ""),
            "mesh-syntax",
            0,
        ),
        (
            "a.ply",
            replaced(&p, "vertex_indices", "corners"),
            "mesh-empty",
            0,
        ),
        (
            "a.ply",
            replaced(&p, "element face", "element tristrips"),
            "mesh-unsupported",
            0,
        ),
        (
            "a.ply",
            replaced(&p, "vertex 8", "vertex 800"),
            "mesh-too-short",
            0,
        ),
        (
            "a.ply",
            replaced(&p, "vertex 8", "vertex 18446744073709551615"),
            "mesh-too-short",
            0,
        ),
        (
            "a.ply",
            replaced(&p, "vertex 8", "vertex 18446744073709551616"),
            "mesh-syntax",
            4,
        ),
        (
            "a.ply",
            replaced(&p, "vertex 8", "vertex 7"),
            "mesh-bad-value",
            22,
        ),
        (
            "a.ply",
            replaced(&p, "-0.75 -2 7.5 200", "-0.75 -2 up 200"),
            "mesh-bad-value",
            15,
        ),
        (
            "a.ply",
            replaced(&p, "-0.75 -2 7.5 200", "-0.75 -2 7.5"),
            "mesh-bad-value",
            15,
        ),
        (
            "a.ply",
            replaced(&p, "4 0 4 6 2", "4 0 4 6 8"),
            "mesh-index",
            0,
        ),
        (
            "a.ply",
            replaced(&p, "4 0 4 6 2", "4 0 4 6 -2"),
            "mesh-index",
            23,
        ),
        (
            "a.ply",
            replaced(&p, "4 0 4 6 2", "4000000000 0 4 6 2"),
            "mesh-bad-value",
            23,
        ),
        (
            "a.ply",
            replaced(&p, "4 0 4 6 2", "4e39 0 4 6 2"),
            "mesh-bad-value",
            23,
        ),
        (
            "a.ply",
            replaced(&p, "list uchar int vertex", "list uchar float vertex"),
            "mesh-index",
            23,
        ),
        ("a.ply", cut(p.clone(), 20), "mesh-bad-value", 27),
        ("a.ply", cut(l.clone(), 12), "mesh-too-short", 0),
        (
            "a.ply",
            replaced(&l, "element edge 1", "element edge 9223372036854775807"),
            "mesh-too-short",
            0,
        ),
        (
            "a.ply",
            replaced(&p, "4 0 4 6 2", &"4 ".repeat(1 << 19)),
            "mesh-too-large",
            0,
        ),
        ("a.stl", cut(stl_binary(), 1), "mesh-too-short", 0),
        (
            "a.stl",
            replaced(&stl_text(), "endloop", "endlop"),
            "mesh-syntax",
            2,
        ),
        (
            "a.stl",
            replaced(&stl_text(), "   vertex 1.25", "   vertex nan"),
            "mesh-syntax",
            16,
        ),
        (
            "a.stl",
            replaced(&stl_text(), "endsolid\n\n", "endsolid\nfacet\n"),
            "mesh-syntax",
            38,
        ),
        ("a.stl", cut(stl_text(), 20), "mesh-too-short", 0),
        ("a.stl.gz", cut(gzip(&stl_text()), 20), "mesh-too-short", 0),
        (
            "a.stl.gz",
            b"\x1f\x8bnothing like gzip".to_vec(),
            "mesh-syntax",
            0,
        ),
        ("a.obj.gz", gzip(&vec![b'\n'; 2 << 20]), "mesh-too-large", 0),
    ];
    let mut wrong = Vec::new();
    for (i, (name, bytes, code, line)) in cases.iter().enumerate() {
        match read(name, bytes) {
            Ok(mesh) => wrong.push(format!("{i} was read: {}", mesh.report())),
            Err(error) => {
                let trouble = error.trouble();
                // Where a file ends too soon there may be no line to name.
                let lines = trouble.line == *line
                    || (*line == 0 && trouble.line > 0 && *code == "mesh-too-short");
                if error.code() != *code || !lines {
                    wrong.push(format!(
                        "{i} expected {code} on {line}: [{}] {error}",
                        error.code()
                    ));
                }
                says_something(&error, name);
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn forged_counts_are_held_against_the_length() {
    let forged = "element vertex 1000000000";
    for good in [ply_text(), ply_binary(false), ply_binary(true)] {
        let error = read("a.ply", &replaced(&good, "element vertex 8", forged)).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("1000000000 elements \"vertex\" need"),
            "{error}"
        );
    }
}

#[test]
fn endless_lines_are_refused() {
    let options = ReadOptions::default();
    let line = "4 ".repeat(1 << 20);
    for (name, bytes, at) in [
        ("a.ply", replaced(&ply_text(), "4 0 4 6 2", &line), 23),
        ("a.stl", replaced(&stl_text(), "outer loop", &line), 3),
    ] {
        let error = Mesh::from_bytes(name, &bytes, &options).unwrap_err();
        assert_eq!(error.code(), "mesh-unsupported");
        assert_eq!(error.trouble().line, at);
        says_something(&error, name);
    }
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().to_path_buf(), folder.path().join("none.ply")] {
        let error = Mesh::read(&path, &ReadOptions::default()).unwrap_err();
        assert_eq!(error.code(), "mesh-unreadable");
        assert_eq!(error.trouble().file, path);
    }
}

#[test]
fn degenerate_and_unused_things_are_counted() {
    let mesh = read(
        "a.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nv 1 0 0\nf 1 2 3\nf 1 2 5\nf 1 1 2\n",
    )
    .unwrap();
    let report = mesh.report();
    assert_eq!(
        (
            report.triangles,
            report.degenerate,
            report.duplicates,
            report.places
        ),
        (1, 2, 1, 3)
    );
    assert_eq!(report.bounds.1, DVec3::new(1.0, 1.0, 0.0));
}
