//! Tiny files in each format, good ones, bad ones, and bad ones by chance.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::io::Write as _;
use std::path::Path;

use common::{Random, cuboid, moved};
use glam::DVec3;
use volgraph_mesh::{Mesh, MeshError, ReadOptions};
use volgraph_report::Finding;

fn read(name: &str, bytes: &[u8]) -> Result<Mesh, MeshError> {
    let options = ReadOptions {
        max_bytes: Some(1 << 20),
    };
    Mesh::from_bytes(name, bytes, &options)
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    out.write_all(bytes).unwrap();
    out.finish().unwrap()
}

/// A box whose corners a float32 holds, in quads.
const QUADS: [[u32; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];
const HALF: DVec3 = DVec3::new(1.0, 2.0, 0.5);

fn corners() -> Vec<[f64; 3]> {
    let positions = moved(cuboid(HALF), DVec3::new(0.25, 0.0, 8.0), 1.0).0;
    positions.iter().map(DVec3::to_array).collect()
}

fn obj() -> Vec<u8> {
    let mut text = "# a box\nmtllib a.mtl\no first\n".to_owned();
    for [x, y, z] in corners() {
        text += &format!("v {x} {y} {z:e} 1.0\nvn 0 0 1\nvt 0 0\n");
    }
    for (i, quad) in QUADS.iter().enumerate() {
        let [a, b, c, d] = quad.map(|i| i + 1);
        text += &match i {
            0 => format!("g part\nf {a} {b} {c} {d}\n"),
            1 => format!("o second\nf {a}/1 {b}/1 {c}/2 {d}/3 # quad\n"),
            2 => format!("f {a}//1 {b}//1 \\\n {c}//1 {d}//1\r\n"),
            3 => {
                let back = |i: u32| i64::from(i) - 9;
                format!("f {} {} {} {}\n", back(a), back(b), back(c), back(d))
            }
            _ => format!("usemtl red\nf {a}/1/1 {b}/1/1 {c}/1/1\nf {a} {c} {d}\n"),
        };
    }
    text.into_bytes()
}

fn ply_header(format: &str, coordinate: &str, list: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a box\nelement vertex 8\nproperty {coordinate} x\nproperty {coordinate} y\n\
         property {coordinate} z\nproperty uchar red\nelement face 6\nproperty list {list} vertex_indices\n\
         element edge 1\nproperty int vertex1\nproperty list uchar short more\nend_header\n"
    )
}

fn ply_text() -> Vec<u8> {
    let mut text = ply_header("ascii", "float", "uchar int");
    for [x, y, z] in corners() {
        text += &format!("{x} {y} {z} 200\n");
    }
    for [a, b, c, d] in QUADS {
        text += &format!("4 {a} {b} {c} {d}\n");
    }
    text += "3 2 7 7\n";
    text.into_bytes()
}

fn ply_binary(big: bool) -> Vec<u8> {
    let (format, coordinate, list) = match big {
        true => ("binary_big_endian", "double", "int ushort"),
        false => ("binary_little_endian", "float", "uchar uint"),
    };
    let mut bytes = ply_header(format, coordinate, list).into_bytes();
    for corner in corners() {
        for number in corner {
            if big {
                bytes.extend(number.to_be_bytes());
            } else {
                bytes.extend((number as f32).to_le_bytes());
            }
        }
        bytes.push(200);
    }
    for quad in QUADS {
        if big {
            bytes.extend(4_i32.to_be_bytes());
            bytes.extend(quad.iter().flat_map(|&i| (i as u16).to_be_bytes()));
        } else {
            bytes.push(4);
            bytes.extend(quad.iter().flat_map(|&i| i.to_le_bytes()));
        }
    }
    bytes.extend([0, 0, 0, 1, 2, 0, 1, 0, 2]);
    bytes
}

fn triangles() -> Vec<[[f64; 3]; 3]> {
    let corners = corners();
    QUADS
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .map(|triangle| triangle.map(|i| corners[i as usize]))
        .collect()
}

fn stl_binary() -> Vec<u8> {
    // Begins as a text would: the length tells.
    let mut bytes = b"solid made by a program that does not know better".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12_u32.to_le_bytes());
    for triangle in triangles() {
        bytes.extend([0; 12]);
        let numbers = triangle.into_iter().flatten();
        bytes.extend(numbers.flat_map(|number| (number as f32).to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

/// Two solids, one without a name.
fn stl_text() -> Vec<u8> {
    let mut text = "solid\n".to_owned();
    for (i, triangle) in triangles().iter().enumerate() {
        if i == 5 {
            text += "endsolid\n\nsolid second one\n";
        }
        text += " facet normal 0 0 0\n  outer loop\n";
        for [x, y, z] in triangle {
            text += &format!("   vertex {x} {y:e} {z}\n");
        }
        text += "  endloop\n endfacet\n";
    }
    text += "endsolid second one\n";
    text.into_bytes()
}

fn files() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    vec![
        ("a.obj", "OBJ", obj()),
        ("b.ply", "PLY ascii", ply_text()),
        ("c.ply", "PLY binary", ply_binary(false)),
        ("d.ply", "PLY binary", ply_binary(true)),
        ("e.stl", "STL binary", stl_binary()),
        ("f.stl", "STL ascii", stl_text()),
    ]
}

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

fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at = bytes
        .windows(from.len())
        .position(|part| part == from.as_bytes());
    let at = at.unwrap_or_else(|| panic!("no {from:?}"));
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
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

fn says_something(error: &MeshError, name: &str) {
    let trouble = error.trouble();
    assert_eq!(trouble.file, Path::new(name), "{error}");
    for text in [&trouble.cause, &trouble.remedy] {
        assert!(
            text.len() > 5 && !text.ends_with('.') && !text.contains('\n'),
            "{error}"
        );
    }
    assert!(Finding::from(error.clone()).place.is_some());
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

/// One change: a bit, a cut, a piece repeated or lost, a number replaced by a nasty one.
fn change(bytes: &mut Vec<u8>, random: &mut Random) {
    const NASTY: [&str; 14] = [
        "0",
        "-1",
        "-9223372036854775808",
        "18446744073709551615",
        "4294967296",
        "4294967295",
        "1e999",
        "nan",
        "-inf",
        "",
        "1000000000",
        "255",
        "1e-320",
        "2147483648",
    ];
    if bytes.is_empty() {
        return;
    }
    let at = random.below(bytes.len());
    let end = (at + random.below(60)).min(bytes.len());
    match random.below(6) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = random.below(256) as u8,
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(at..end)),
        4 => {
            let piece = bytes[at..end].to_vec();
            bytes.splice(at..at, piece);
        }
        _ => {
            let starts: Vec<usize> = (0..bytes.len())
                .filter(|&i| {
                    bytes[i].is_ascii_digit() && (i == 0 || !bytes[i - 1].is_ascii_digit())
                })
                .collect();
            let Some(&start) = starts.get(random.below(starts.len().max(1))) else {
                return;
            };
            let digits = bytes[start..]
                .iter()
                .take_while(|byte| byte.is_ascii_digit())
                .count();
            let nasty = NASTY[random.below(NASTY.len())];
            bytes.splice(start..start + digits, nasty.bytes());
        }
    }
}

#[test]
fn whatever_the_bytes_are_there_is_a_mesh_or_a_reason() {
    let mut random = Random(11);
    for (name, _, good) in files() {
        let (mut read_well, mut refused) = (0, 0);
        for _ in 0..2000 {
            let mut bytes = good.clone();
            for _ in 0..1 + random.below(3) {
                change(&mut bytes, &mut random);
            }
            match read(name, &bytes) {
                Ok(mesh) => {
                    read_well += 1;
                    assert!(mesh.positions().iter().all(|position| position.is_finite()));
                    assert!(
                        mesh.triangles()
                            .iter()
                            .flatten()
                            .all(|&i| (i as usize) < mesh.positions().len())
                    );
                    let _ = mesh.report().to_string();
                }
                Err(error) => {
                    refused += 1;
                    says_something(&error, name);
                }
            }
        }
        assert!(
            read_well > 50 && refused > 200,
            "{name}: {read_well} read, {refused} refused"
        );
    }
    for _ in 0..2000 {
        let start = [
            &b"ply\n"[..],
            b"solid \nfacet",
            b"v ",
            b"\x1f\x8b\x08\0",
            b"",
        ][random.below(5)];
        let mut bytes = start.to_vec();
        bytes.extend((0..random.below(200)).map(|_| random.below(256) as u8));
        if let Err(error) = read("a.stl", &bytes) {
            says_something(&error, "a.stl");
        }
    }
}
