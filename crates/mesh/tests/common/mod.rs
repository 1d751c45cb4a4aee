//! What the tests share: shapes whose distances are known, files of them, where the data lies.
#![allow(dead_code, reason = "each test binary uses a part of it")]

pub mod files;

use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::PathBuf;

use glam::DVec3;
use volgraph_mesh::Mesh;

pub type Faces = (Vec<DVec3>, Vec<[u32; 3]>);

/// The folder of shared test data: VOLGRAPH_DATA, or `../shared/data` beside the workspace.
pub fn data_folder() -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let folder = std::env::var_os("VOLGRAPH_DATA").map_or(PathBuf::from(beside), PathBuf::from);
    folder.is_dir().then_some(folder)
}

pub fn mesh((positions, triangles): Faces) -> Mesh {
    Mesh::new("test", positions, triangles).unwrap()
}

/// Numbers that look random, the same each time.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// In the cube from -size to size.
    pub fn point(&mut self, size: f64) -> DVec3 {
        (DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0) * size
    }
}

/// An axis-aligned box about the origin, each face of two triangles.
pub fn cuboid(half: DVec3) -> Faces {
    let corner = |i: u32| {
        let side = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
        DVec3::new(side(1), side(2), side(4)) * half
    };
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    ((0..8).map(corner).collect(), triangles)
}

pub fn cuboid_distance(p: DVec3, half: DVec3) -> f64 {
    let q = p.abs() - half;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

/// A ball of radius 1 about the origin: an icosahedron, each triangle cut into four `levels` times.
pub fn icosphere(levels: u32) -> Faces {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut positions: Vec<DVec3> = [
        (-1.0, g, 0.0),
        (1.0, g, 0.0),
        (-1.0, -g, 0.0),
        (1.0, -g, 0.0),
        (0.0, -1.0, g),
        (0.0, 1.0, g),
        (0.0, -1.0, -g),
        (0.0, 1.0, -g),
        (g, 0.0, -1.0),
        (g, 0.0, 1.0),
        (-g, 0.0, -1.0),
        (-g, 0.0, 1.0),
    ]
    .map(|p| DVec3::from(p).normalize())
    .to_vec();
    let mut triangles: Vec<[u32; 3]> = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ]
    .to_vec();
    for _ in 0..levels {
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let both = positions[a as usize] + positions[b as usize];
                    positions.push(both.normalize());
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    (positions, triangles)
}

/// A torus about the z axis.
pub fn torus(large: f64, small: f64, around: u32, across: u32) -> Faces {
    let point = |i: u32, j: u32| {
        let u = f64::from(i) / f64::from(around) * 2.0 * PI;
        let v = f64::from(j) / f64::from(across) * 2.0 * PI;
        let r = large + small * v.cos();
        DVec3::new(r * u.cos(), r * u.sin(), small * v.sin())
    };
    let positions = (0..around)
        .flat_map(|i| (0..across).map(move |j| point(i, j)))
        .collect();
    let at = |i: u32, j: u32| (i % around) * across + j % across;
    let triangles = (0..around)
        .flat_map(|i| (0..across).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    (positions, triangles)
}

pub fn torus_distance(p: DVec3, large: f64, small: f64) -> f64 {
    (p.x.hypot(p.y) - large).hypot(p.z) - small
}

/// Without the triangles of which a corner is above `z`.
pub fn below(z: f64, (positions, mut triangles): Faces) -> Faces {
    triangles.retain(|corners| {
        corners
            .iter()
            .all(|&corner| positions[corner as usize].z <= z + 1e-9)
    });
    (positions, triangles)
}

pub fn moved((mut positions, triangles): Faces, by: DVec3, scale: f64) -> Faces {
    for position in &mut positions {
        *position = *position * scale + by;
    }
    (positions, triangles)
}

pub fn turned((positions, mut triangles): Faces) -> Faces {
    triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
    (positions, triangles)
}

pub fn both((mut positions, mut triangles): Faces, other: Faces) -> Faces {
    let first = positions.len() as u32;
    positions.extend(other.0);
    triangles.extend(other.1.iter().map(|corners| corners.map(|i| i + first)));
    (positions, triangles)
}
