//! Signed distance to a mesh, at any point.
//!
//! The mesh is moved to its middle and scaled to unit size, so that squares of coordinates stay in range; a tree
//! gives the nearest point, and pseudo-normals or winding numbers the sign, whichever the mesh's report allows.

use std::fmt;

use glam::DVec3;
use volgraph_volume::Trouble;

use crate::pseudonormal::PseudoNormals;
use crate::topology::Topology;
use crate::tree::{Nearest, Tree};
use crate::winding::Winding;
use crate::{Mesh, MeshError, MeshReport};

/// How inside and outside are told apart, as the user says it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sign {
    /// Pseudo-normals for a closed, oriented mesh whose components do not meet, winding numbers for all others.
    #[default]
    Auto,
    /// Pseudo-normals, whatever the mesh is like.
    PseudoNormal,
    /// Winding numbers.
    Winding,
    /// No inside: all distances are positive.
    Unsigned,
}

impl std::str::FromStr for Sign {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            "pseudonormal" => Ok(Self::PseudoNormal),
            "winding" => Ok(Self::Winding),
            "unsigned" => Ok(Self::Unsigned),
            _ => Err(format!(
                "{text:?} is none of `auto`, `pseudonormal`, `winding` and `unsigned`"
            )),
        }
    }
}

/// How inside and outside are told apart, after the report was looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignMethod {
    /// By the pseudo-normal at the nearest point: exact for closed meshes.
    PseudoNormal,
    /// By the generalised winding number: inside where it is above 1/2.
    Winding,
    /// Not at all.
    Unsigned,
}

impl fmt::Display for SignMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PseudoNormal => "pseudo-normals",
            Self::Winding => "winding numbers",
            Self::Unsigned => "none (unsigned)",
        })
    }
}

enum Side {
    PseudoNormal(PseudoNormals),
    Winding(Winding),
    Unsigned,
}

/// Meshes of this half size and its inverse are scaled to 1 without loss, and their distances fit a float32.
const SIZES: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// Answers how far points are from a mesh. Shared among threads at will.
pub struct SignedDistance {
    tree: Tree,
    side: Side,
    /// Whether the sign changes at the surface alone.
    closed: bool,
    middle: DVec3,
    size: f64,
    report: MeshReport,
    warnings: Vec<String>,
}

impl SignedDistance {
    /// Prepares a mesh: a tree, and what the sign needs. A mesh whose faces look inwards (negative volume) is turned
    /// around, with a warning.
    ///
    /// # Errors
    /// [`MeshError::BadValue`] where the mesh is smaller than 1e-30 or larger than 1e30, or flatter than float64 can
    /// tell at its distance from the origin.
    pub fn new(mesh: &Mesh, sign: Sign) -> Result<Self, MeshError> {
        let topology = Topology::of(mesh);
        let report = MeshReport::of(mesh, &topology);
        let (lo, hi) = report.bounds;
        let size = (hi / 2.0 - lo / 2.0).max_element();
        let middle = lo.midpoint(hi);
        if !SIZES.contains(&size) || !middle.is_finite() {
            return Err(MeshError::BadValue(Trouble::new(
                format!("spans {lo} to {hi}, too small or too large for distances in float32"),
                "scale the mesh to a common unit such as millimetres",
            )));
        }
        let triangles: Vec<[DVec3; 3]> = mesh
            .corners()
            .map(|corners| corners.map(|corner| (corner - middle) / size))
            .collect();
        let mut tree = Tree::new(&triangles);
        drop(triangles);

        let method = method(sign, &report);
        let mut warnings = Vec::new();
        let mut topology = topology;
        if method != SignMethod::Unsigned && report.signed_volume < 0.0 {
            warnings.push(format!(
                "the faces look inwards (the signed volume is {}); they were turned around",
                report.signed_volume
            ));
            turn_around(&mut tree, &mut topology);
        }
        let trusted = report.is_watertight() && report.is_oriented();
        if method == SignMethod::Winding && !trusted {
            warnings.push(open_warning(&report));
        }
        if method == SignMethod::PseudoNormal && (!trusted || report.components_meet) {
            warnings.push(
                "pseudo-normals were asked for, but the mesh is not closed and oriented with components apart; signs \
                 may be wrong"
                    .into(),
            );
        }
        let side = match method {
            SignMethod::PseudoNormal => Side::PseudoNormal(PseudoNormals::new(&tree, &topology)),
            SignMethod::Winding => Side::Winding(Winding::new(&tree)),
            SignMethod::Unsigned => Side::Unsigned,
        };
        Ok(Self {
            tree,
            side,
            closed: trusted,
            middle,
            size,
            report,
            warnings,
        })
    }

    /// The distance at a point, in mesh units: negative inside.
    #[must_use]
    pub fn at(&self, point: DVec3) -> f64 {
        self.walker().at(point)
    }

    /// How the sign is found.
    #[must_use]
    pub fn method(&self) -> SignMethod {
        match self.side {
            Side::PseudoNormal(_) => SignMethod::PseudoNormal,
            Side::Winding(_) => SignMethod::Winding,
            Side::Unsigned => SignMethod::Unsigned,
        }
    }

    /// The report of the mesh.
    #[must_use]
    pub fn report(&self) -> &MeshReport {
        &self.report
    }

    /// What the user should know: a mesh turned around, holes.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The winding number at a point; `None` where another method is used.
    #[must_use]
    pub fn winding_number(&self, point: DVec3) -> Option<f64> {
        match &self.side {
            Side::Winding(winding) => {
                Some(winding.at(&self.tree, (point - self.middle) / self.size))
            }
            _ => None,
        }
    }

    /// For many points of which each is near the one before.
    pub(crate) fn walker(&self) -> Walker<'_> {
        Walker {
            of: self,
            triangle: 0,
            last: None,
        }
    }

    fn inside(&self, p: DVec3, nearest: &Nearest) -> bool {
        match &self.side {
            Side::PseudoNormal(normals) => normals.inside(p, nearest),
            Side::Winding(winding) => winding.at(&self.tree, p) > 0.5,
            Side::Unsigned => false,
        }
    }
}

/// Asks for one point after another, and uses what it learned.
pub(crate) struct Walker<'a> {
    of: &'a SignedDistance,
    /// The nearest one of the point before.
    triangle: u32,
    /// The point before, its distance (or less) and its side.
    last: Option<(DVec3, f64, bool)>,
}

impl Walker<'_> {
    pub fn at(&mut self, point: DVec3) -> f64 {
        self.within(point, f64::INFINITY)
    }

    /// The distance, clamped to ±`band`. A closed surface has one side within each ball that does not touch it, so
    /// the sign of the point before is taken where that point lies in such a ball.
    pub fn within(&mut self, point: DVec3, band: f64) -> f64 {
        let of = self.of;
        let p = (point - of.middle) / of.size;
        let band = band / of.size;
        let same_side = |distance: f64, last: &Option<(DVec3, f64, bool)>| {
            let (before, there, inside) = (*last)?;
            (of.closed && before.distance(p) < distance.max(there)).then_some(inside)
        };
        if let Some(inside) = same_side(band, &self.last) {
            let found = of.tree.nearest_within(p, self.triangle, band * band);
            let Some(nearest) = found else {
                self.last = Some((p, band, inside));
                return signed(band, inside) * of.size;
            };
            return self.settle(p, nearest, band);
        }
        let nearest = of.tree.nearest(p, self.triangle);
        self.settle(p, nearest, band)
    }

    fn settle(&mut self, p: DVec3, nearest: Nearest, band: f64) -> f64 {
        let of = self.of;
        let distance = nearest.squared.sqrt();
        // Pseudo-normals cost less than to ask whether they are needed.
        let known = match (&of.side, self.last) {
            (Side::Winding(_), Some((before, there, inside)))
                if of.closed && before.distance(p) < distance.max(there) =>
            {
                Some(inside)
            }
            _ => None,
        };
        let inside = known.unwrap_or_else(|| of.inside(p, &nearest));
        self.triangle = nearest.triangle;
        self.last = Some((p, distance, inside));
        signed(distance.min(band), inside) * of.size
    }
}

fn signed(distance: f64, inside: bool) -> f64 {
    if inside { -distance } else { distance }
}

fn method(sign: Sign, report: &MeshReport) -> SignMethod {
    let simple = report.is_watertight() && report.is_oriented() && !report.components_meet;
    match sign {
        Sign::Auto if simple => SignMethod::PseudoNormal,
        Sign::Auto | Sign::Winding => SignMethod::Winding,
        Sign::PseudoNormal => SignMethod::PseudoNormal,
        Sign::Unsigned => SignMethod::Unsigned,
    }
}

fn open_warning(report: &MeshReport) -> String {
    let mut found = Vec::new();
    for (count, what) in [
        (report.boundary_edges, "edges of holes"),
        (report.non_manifold_edges, "edges of more than two faces"),
        (
            report.turned_edges,
            "edges between faces that look to different sides",
        ),
    ] {
        if count > 0 {
            found.push(format!("{count} {what}"));
        }
    }
    format!(
        "the mesh is not closed ({}); winding numbers tell inside from outside, and the sign changes within holes",
        found.join(", ")
    )
}

fn turn_around(tree: &mut Tree, topology: &mut Topology) {
    for corners in &mut tree.corners {
        corners.swap(1, 2);
    }
    for corners in &mut topology.triangles {
        corners.swap(1, 2);
    }
    // The edges from corner 0, 1, 2 are now those from 2, 1, 0.
    for half in &mut topology.half_edges {
        (half.corner, half.upwards) = (2 - half.corner, !half.upwards);
    }
}
