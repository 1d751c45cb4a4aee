//! What is to be said of a mesh before a field is made of it.

use std::fmt;

use glam::DVec3;

use crate::Mesh;
use crate::topology::Topology;

/// Counts, bounds, and whether there is an inside. Vertices at one place count as one for everything about edges.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// Vertices as the file has them.
    pub vertices: usize,
    /// Different places where triangles have corners: vertices without repeated and unused ones.
    pub places: usize,
    /// Triangles, polygons cut into fans, without the degenerate ones.
    pub triangles: usize,
    /// Lowest and highest corner of the box around the triangles.
    pub bounds: (DVec3, DVec3),
    /// Triangles that were dropped because they had no area.
    pub degenerate: usize,
    /// Vertices that lie where another one lies already.
    pub duplicates: usize,
    /// Edges with one face: the rims of holes.
    pub boundary_edges: usize,
    /// Edges with three faces or more.
    pub non_manifold_edges: usize,
    /// Edges whose two faces look to different sides.
    pub turned_edges: usize,
    /// Parts that share no edge.
    pub components: usize,
    /// Whether the boxes around two components meet, so that one may lie within the other or cut it.
    pub components_meet: bool,
    /// Vertices - edges + triangles: 2 for each closed part without handles, 2 less per handle.
    pub euler: i64,
    /// The volume within the faces ([`Mesh::signed_volume`]).
    pub signed_volume: f64,
}

/// Boxes are held against each other up to this many components; more are taken to meet.
const MAX_PAIRED: usize = 2000;

impl MeshReport {
    pub(crate) fn of(mesh: &Mesh, topology: &Topology) -> Self {
        let (mut edges, mut boundary, mut non_manifold, mut turned) = (0, 0, 0, 0);
        for edge in topology.edges() {
            edges += 1;
            match edge {
                [_] => boundary += 1,
                [a, b] => turned += usize::from(a.upwards == b.upwards),
                _ => non_manifold += 1,
            }
        }
        Self {
            vertices: mesh.positions().len(),
            places: topology.vertices,
            triangles: mesh.triangles().len(),
            bounds: mesh.bounds(),
            degenerate: mesh.degenerate(),
            duplicates: topology.duplicates,
            boundary_edges: boundary,
            non_manifold_edges: non_manifold,
            turned_edges: turned,
            components: topology.component_count,
            components_meet: components_meet(mesh, topology),
            euler: topology.vertices as i64 - edges + topology.triangles.len() as i64,
            signed_volume: mesh.signed_volume(),
        }
    }

    /// Whether every edge has exactly two faces.
    #[must_use]
    pub fn is_watertight(&self) -> bool {
        self.boundary_edges == 0 && self.non_manifold_edges == 0
    }

    /// Whether all faces that share an edge look to the same side.
    #[must_use]
    pub fn is_oriented(&self) -> bool {
        self.turned_edges == 0
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (lo, hi) = self.bounds;
        let yes = |yes: bool| if yes { "yes" } else { "no" };
        writeln!(f, "vertices            {}", self.vertices)?;
        writeln!(f, "different and used  {}", self.places)?;
        writeln!(f, "triangles           {}", self.triangles)?;
        writeln!(f, "bounds              {lo} to {hi}")?;
        writeln!(f, "components          {}", self.components)?;
        writeln!(f, "watertight          {}", yes(self.is_watertight()))?;
        writeln!(f, "oriented            {}", yes(self.is_oriented()))?;
        writeln!(f, "boundary edges      {}", self.boundary_edges)?;
        writeln!(f, "non-manifold edges  {}", self.non_manifold_edges)?;
        writeln!(f, "turned edges        {}", self.turned_edges)?;
        writeln!(f, "duplicate vertices  {}", self.duplicates)?;
        writeln!(f, "degenerate, dropped {}", self.degenerate)?;
        writeln!(f, "Euler number        {}", self.euler)?;
        write!(f, "signed volume       {}", self.signed_volume)
    }
}

fn components_meet(mesh: &Mesh, topology: &Topology) -> bool {
    if topology.component_count > MAX_PAIRED {
        return true;
    }
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut boxes = vec![nothing; topology.component_count];
    for (corners, &component) in mesh.corners().zip(&topology.components) {
        let around = &mut boxes[component as usize];
        for corner in corners {
            *around = (around.0.min(corner), around.1.max(corner));
        }
    }
    boxes.iter().enumerate().any(|(i, a)| {
        let meets = |b: &(DVec3, DVec3)| a.0.cmple(b.1).all() && b.0.cmple(a.1).all();
        boxes[..i].iter().any(meets)
    })
}
