//! The same small box in each format, and what every refusal must say.

use std::io::Write as _;
use std::path::Path;

use glam::DVec3;
use volgraph_mesh::{Mesh, MeshError, ReadOptions};
use volgraph_report::Finding;

use super::{cuboid, moved};

pub fn read(name: &str, bytes: &[u8]) -> Result<Mesh, MeshError> {
    let options = ReadOptions {
        max_bytes: Some(1 << 20),
    };
    Mesh::from_bytes(name, bytes, &options)
}

pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    out.write_all(bytes).unwrap();
    out.finish().unwrap()
}

/// A box whose corners a float32 holds, in quads.
pub const QUADS: [[u32; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];
pub const HALF: DVec3 = DVec3::new(1.0, 2.0, 0.5);

pub fn corners() -> Vec<[f64; 3]> {
    let positions = moved(cuboid(HALF), DVec3::new(0.25, 0.0, 8.0), 1.0).0;
    positions.iter().map(DVec3::to_array).collect()
}

pub fn obj() -> Vec<u8> {
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

pub fn ply_header(format: &str, coordinate: &str, list: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a box\nelement vertex 8\nproperty {coordinate} x\nproperty {coordinate} y\n\
         property {coordinate} z\nproperty uchar red\nelement face 6\nproperty list {list} vertex_indices\n\
         element edge 1\nproperty int vertex1\nproperty list uchar short more\nend_header\n"
    )
}

pub fn ply_text() -> Vec<u8> {
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

pub fn ply_binary(big: bool) -> Vec<u8> {
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

pub fn triangles() -> Vec<[[f64; 3]; 3]> {
    let corners = corners();
    QUADS
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .map(|triangle| triangle.map(|i| corners[i as usize]))
        .collect()
}

pub fn stl_binary() -> Vec<u8> {
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
pub fn stl_text() -> Vec<u8> {
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

pub fn files() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    vec![
        ("a.obj", "OBJ", obj()),
        ("b.ply", "PLY ascii", ply_text()),
        ("c.ply", "PLY binary", ply_binary(false)),
        ("d.ply", "PLY binary", ply_binary(true)),
        ("e.stl", "STL binary", stl_binary()),
        ("f.stl", "STL ascii", stl_text()),
    ]
}

pub fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at = bytes
        .windows(from.len())
        .position(|part| part == from.as_bytes());
    let at = at.unwrap_or_else(|| panic!("no {from:?}"));
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

pub fn says_something(error: &MeshError, name: &str) {
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
