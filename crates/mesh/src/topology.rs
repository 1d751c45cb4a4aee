//! How triangles hang together: vertices at one place count as one, edges know their faces.
//!
//! Positions that are equal become one vertex (files with normals or texture coordinates, and all STL files, repeat
//! them). All half edges are sorted by their two ends, so that each run of equal ends is an edge; triangles that
//! share an edge are joined to components.

use std::collections::HashMap;

use glam::DVec3;

use crate::Mesh;

/// A half edge: its ends, lower vertex first, the triangle, the corner it leaves, and whether it runs upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct HalfEdge {
    pub ends: [u32; 2],
    pub triangle: u32,
    pub corner: u8,
    pub upwards: bool,
}

pub(crate) struct Topology {
    /// Corners of each triangle, as vertices after welding: the lowest index at a place stands for all.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices that lie where another lies already.
    pub duplicates: usize,
    /// Vertices at different places that belong to a triangle.
    pub vertices: usize,
    /// Sorted by their ends.
    pub half_edges: Vec<HalfEdge>,
    /// Component of each triangle, from 0.
    pub components: Vec<u32>,
    pub component_count: usize,
}

/// Equal for equal positions; 0 and -0 are equal.
pub(crate) fn place(position: DVec3) -> [u64; 3] {
    position.to_array().map(|number| (number + 0.0).to_bits())
}

impl Topology {
    pub fn of(mesh: &Mesh) -> Self {
        let positions = mesh.positions();
        let mut first: HashMap<[u64; 3], u32> = HashMap::with_capacity(positions.len());
        let welded: Vec<u32> = (0..)
            .zip(positions)
            .map(|(i, &position)| *first.entry(place(position)).or_insert(i))
            .collect();
        let duplicates = positions.len() - first.len();
        drop(first);

        let weld = |corners: &[u32; 3]| corners.map(|corner| welded[corner as usize]);
        let triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(weld).collect();
        let mut used = vec![false; positions.len()];
        for &corner in triangles.iter().flatten() {
            used[corner as usize] = true;
        }

        let mut half_edges = Vec::with_capacity(triangles.len() * 3);
        for (triangle, corners) in (0..).zip(&triangles) {
            for corner in 0..3_u8 {
                let (from, to) = (
                    corners[usize::from(corner)],
                    corners[(usize::from(corner) + 1) % 3],
                );
                half_edges.push(HalfEdge {
                    ends: [from.min(to), from.max(to)],
                    triangle,
                    corner,
                    upwards: from < to,
                });
            }
        }
        half_edges.sort_unstable();

        let (components, component_count) = components(triangles.len(), &half_edges);
        Self {
            triangles,
            duplicates,
            vertices: used.iter().filter(|&&used| used).count(),
            half_edges,
            components,
            component_count,
        }
    }

    /// The half edges of each edge.
    pub fn edges(&self) -> impl Iterator<Item = &[HalfEdge]> {
        self.half_edges.chunk_by(|a, b| a.ends == b.ends)
    }
}

/// Joins triangles that share an edge, by union and find.
fn components(count: usize, half_edges: &[HalfEdge]) -> (Vec<u32>, usize) {
    fn root(parents: &mut [u32], mut i: u32) -> u32 {
        while parents[i as usize] != i {
            let above = parents[parents[i as usize] as usize];
            parents[i as usize] = above;
            i = above;
        }
        i
    }
    let mut parents: Vec<u32> = (0..count as u32).collect();
    for edge in half_edges.chunk_by(|a, b| a.ends == b.ends) {
        for pair in edge.windows(2) {
            let a = root(&mut parents, pair[0].triangle);
            let b = root(&mut parents, pair[1].triangle);
            parents[a.max(b) as usize] = a.min(b);
        }
    }
    let mut number = vec![u32::MAX; count];
    let mut next = 0;
    let components = (0..count as u32)
        .map(|i| {
            let root = root(&mut parents, i) as usize;
            if number[root] == u32::MAX {
                number[root] = next;
                next += 1;
            }
            number[root]
        })
        .collect();
    (components, next as usize)
}
