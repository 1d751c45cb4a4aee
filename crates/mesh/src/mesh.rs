//! A mesh: positions and triangles, checked.

use std::path::{Path, PathBuf};

use glam::DVec3;
use volgraph_volume::Trouble;

use crate::MeshError;
use crate::read::{self, ReadOptions};
use crate::report::MeshReport;
use crate::topology::Topology;
use crate::triangle;

/// Triangles in space. Every index is valid, every position finite, and every triangle has three different corners
/// and an area.
#[derive(Clone, Debug)]
pub struct Mesh {
    name: String,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    degenerate: usize,
    format: String,
    source_files: Vec<PathBuf>,
    warnings: Vec<String>,
}

/// Which axis of a mesh points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// z: the mesh is taken as it is, x to the left, y to posterior, z to superior.
    #[default]
    Z,
    /// y, as most modelling programs write: a quarter turn about x takes (x, y, z) to (x, -z, y). What was up is
    /// superior then, and what looked along +z, to the viewer, looks to anterior.
    Y,
}

impl std::str::FromStr for Up {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "y" => Ok(Self::Y),
            "z" => Ok(Self::Z),
            _ => Err(format!("{text:?} is none of `y` and `z`")),
        }
    }
}

impl Mesh {
    /// A mesh of positions and triangles at hand. Triangles whose corners coincide or lie on a line are dropped;
    /// [`MeshReport::degenerate`] counts them.
    ///
    /// # Errors
    /// [`MeshError::BadValue`] where a position is not finite, [`MeshError::Index`] where a triangle names a vertex
    /// that does not exist, [`MeshError::Empty`] where no triangle has an area, [`MeshError::TooLarge`] beyond 2³²-1
    /// vertices or triangles.
    pub fn new(
        name: impl Into<String>,
        positions: Vec<DVec3>,
        mut triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        if positions.len().max(triangles.len()) >= u32::MAX as usize {
            return Err(MeshError::TooLarge(Trouble::new(
                "has more than 4294967294 vertices or triangles",
                "simplify the mesh, or split it",
            )));
        }
        if let Some(i) = positions.iter().position(|position| !position.is_finite()) {
            return Err(MeshError::BadValue(Trouble::new(
                format!("vertex {i} (from 0) lies at {}", positions[i]),
                "give every vertex three finite coordinates",
            )));
        }
        let count = positions.len();
        if let Some(i) = triangles
            .iter()
            .position(|corners| corners.iter().any(|&corner| corner as usize >= count))
        {
            return Err(MeshError::Index(Trouble::new(
                format!(
                    "triangle {i} (from 0) has the corners {:?} of {count} vertices",
                    triangles[i]
                ),
                "name vertices that exist",
            )));
        }
        let given = triangles.len();
        triangles.retain(|corners| {
            let corners = corners.map(|corner| positions[corner as usize]);
            triangle::has_area(&corners)
        });
        if triangles.is_empty() {
            return Err(MeshError::Empty(Trouble::new(
                format!("has no triangle with an area ({count} vertices, {given} triangles)"),
                "give a mesh with faces; point clouds and lines have no inside",
            )));
        }
        Ok(Self {
            name: name.into(),
            degenerate: given - triangles.len(),
            positions,
            triangles,
            format: String::new(),
            source_files: Vec::new(),
            warnings: Vec::new(),
        })
    }

    /// Reads a PLY, OBJ or STL file, plain or in gzip; the content tells which, then the name.
    ///
    /// # Errors
    /// A [`MeshError`] that names the file, the line where there is one, the cause and the remedy.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self, MeshError> {
        read::read(path, options)
    }

    /// As [`Mesh::read`], from the bytes of a whole file; `name` is the file's name.
    ///
    /// # Errors
    /// As [`Mesh::read`].
    pub fn from_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self, MeshError> {
        read::from_bytes(Path::new(name), bytes, options)
    }

    pub(crate) fn with_source(
        mut self,
        format: String,
        file: &Path,
        warnings: Vec<String>,
    ) -> Self {
        self.format = format;
        self.source_files = vec![file.to_path_buf()];
        self.warnings = warnings;
        self
    }

    /// A short name: the file's without its endings.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file's format, such as `PLY binary`; empty where there was no file.
    #[must_use]
    pub fn format(&self) -> &str {
        &self.format
    }

    /// The files it was read from.
    #[must_use]
    pub fn source_files(&self) -> &[PathBuf] {
        &self.source_files
    }

    /// What the reader wants the user to know.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Where the vertices are, as the file has them.
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Three vertices each; seen from outside they go round counter-clockwise.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// How many triangles were dropped because they had no area.
    #[must_use]
    pub fn degenerate(&self) -> usize {
        self.degenerate
    }

    /// The corners of each triangle.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = [DVec3; 3]> + '_ {
        let position = |corner: u32| self.positions[corner as usize];
        self.triangles
            .iter()
            .map(move |corners| corners.map(position))
    }

    /// Lowest and highest corner of the box around all triangles; vertices of no triangle do not count.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.corners()
            .flatten()
            .fold(nothing, |(lo, hi), corner| (lo.min(corner), hi.max(corner)))
    }

    /// The volume within the faces, by the divergence theorem about the middle of the bounds: exact for a closed
    /// mesh, negative where its faces look inwards; for an open one a hint at which way they look.
    #[must_use]
    pub fn signed_volume(&self) -> f64 {
        let (lo, hi) = self.bounds();
        let middle = lo.midpoint(hi);
        self.corners()
            .map(|corners| corners.map(|corner| corner - middle))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum()
    }

    /// What is to be said of it: counts, bounds, and whether it has an inside.
    #[must_use]
    pub fn report(&self) -> MeshReport {
        MeshReport::of(self, &Topology::of(self))
    }

    /// Turned so that `up` is the z axis of the world.
    #[must_use]
    pub fn turned(mut self, up: Up) -> Self {
        if up == Up::Y {
            for position in &mut self.positions {
                *position = DVec3::new(position.x, -position.z, position.y);
            }
        }
        self
    }

    /// With every face turned around.
    #[must_use]
    pub fn flipped(mut self) -> Self {
        for corners in &mut self.triangles {
            corners.swap(1, 2);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_up_becomes_z_and_what_looks_at_the_viewer_looks_to_anterior() {
        let corners = vec![DVec3::X, DVec3::Y, DVec3::Z];
        let mesh = Mesh::new("a", corners, vec![[0, 1, 2]]).unwrap();
        let turned = mesh.clone().turned(Up::Y);
        assert_eq!(turned.positions(), [DVec3::X, DVec3::Z, DVec3::NEG_Y]);
        // A turn, no mirror: the volume keeps its sign.
        let volume = |mesh: &Mesh| {
            let corner = mesh.corners().next().unwrap();
            corner[0].dot(corner[1].cross(corner[2]))
        };
        assert_eq!(volume(&turned), volume(&mesh));
        assert_eq!(mesh.clone().turned(Up::Z).positions(), mesh.positions());
        assert_eq!(volume(&mesh.clone().flipped()), -volume(&mesh));
    }

    #[test]
    fn what_is_no_mesh_is_refused() {
        let points = |last: f64| vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, last, 0.0)];
        let code = |positions, triangles| {
            let error = Mesh::new("a", positions, triangles).unwrap_err();
            assert!(!error.trouble().remedy.is_empty());
            error.code()
        };
        assert_eq!(code(points(f64::NAN), vec![[0, 1, 2]]), "mesh-bad-value");
        assert_eq!(code(points(1.0), vec![[0, 1, 3]]), "mesh-index");
        assert_eq!(code(points(0.0), vec![[0, 1, 2]]), "mesh-empty");
        assert_eq!(code(points(1.0), Vec::new()), "mesh-empty");
        let mesh = Mesh::new("a", points(1.0), vec![[0, 1, 2], [0, 1, 1]]).unwrap();
        assert_eq!((mesh.triangles().len(), mesh.degenerate()), (1, 1));
    }
}
