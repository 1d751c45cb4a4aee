//! Pseudo-normals: which side of a closed mesh a point lies on, by its nearest point alone.
//!
//! The normal of the face, the sum of both normals on an edge, the sum weighted by the corner's angles at a vertex:
//! with these the sign of (p - nearest) · normal is exact for closed meshes that do not cut themselves (Bærentzen &
//! Aanæs 2005).

use glam::DVec3;

use crate::topology::Topology;
use crate::tree::{Nearest, Tree};
use crate::triangle::Feature;

pub(crate) struct PseudoNormals {
    /// By triangle in the order of the tree: face, three edges, three corners.
    triangles: Vec<[DVec3; 7]>,
}

impl PseudoNormals {
    pub fn new(tree: &Tree, topology: &Topology) -> Self {
        let mut by_number = vec![[DVec3::ZERO; 7]; tree.corners.len()];
        let vertices = topology.triangles.iter().flatten().max();
        let mut at_vertex = vec![DVec3::ZERO; vertices.map_or(0, |&last| last as usize + 1)];
        for (corners, &number) in tree.corners.iter().zip(&tree.numbers) {
            let [a, b, c] = *corners;
            let size = (b - a).abs().max((c - a).abs()).max_element();
            let normal = ((b - a) / size).cross((c - a) / size).normalize_or_zero();
            by_number[number as usize][0] = normal;
            for i in 0..3 {
                let here = corners[i];
                let (u, v) = (corners[(i + 1) % 3] - here, corners[(i + 2) % 3] - here);
                let vertex = topology.triangles[number as usize][i] as usize;
                at_vertex[vertex] += normal * u.cross(v).length().atan2(u.dot(v));
            }
        }
        for edge in topology.edges() {
            let normals = edge.iter().map(|half| by_number[half.triangle as usize][0]);
            let sum: DVec3 = normals.sum();
            for half in edge {
                by_number[half.triangle as usize][1 + usize::from(half.corner)] = sum;
            }
        }
        for (normals, corners) in by_number.iter_mut().zip(&topology.triangles) {
            for i in 0..3 {
                normals[4 + i] = at_vertex[corners[i] as usize];
            }
        }
        let numbers = tree.numbers.iter();
        Self {
            triangles: numbers.map(|&i| by_number[i as usize]).collect(),
        }
    }

    /// Whether `p`, whose nearest point is given, lies inside.
    pub fn inside(&self, p: DVec3, nearest: &Nearest) -> bool {
        let normals = &self.triangles[nearest.triangle as usize];
        let normal = match nearest.feature {
            Feature::Face => normals[0],
            Feature::Edge(i) => normals[1 + i],
            Feature::Corner(i) => normals[4 + i],
        };
        (p - nearest.point).dot(normal) < 0.0
    }
}
