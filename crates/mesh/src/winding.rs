//! The generalised winding number: how often a mesh goes round a point.
//!
//! Of a closed mesh it is 1 inside and 0 outside; where the mesh has holes or overlaps itself it is a smooth guess
//! that passes 1/2 in the hole (Jacobson et al. 2013). Each node of the tree sums its triangles up as a dipole at
//! their centre, which stands for them where the point is far from it (Barill et al. 2018, first term); near
//! triangles count with their true solid angle.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tree::Tree;
use crate::triangle::solid_angle;

/// How many radii away a node stands for its triangles. The next term of the series would not help so near: on
/// curved surfaces it is cancelled by the one after it.
const FAR: f64 = 2.5;

/// A node seen from afar.
#[derive(Clone, Copy, Debug)]
struct Moments {
    /// Of the triangles, weighted by area.
    centre: DVec3,
    area: f64,
    /// Sum of area times normal.
    dipole: DVec3,
    /// Of a ball about the centre that holds the node's box, squared and times FAR².
    far_squared: f64,
}

pub(crate) struct Winding(Vec<Moments>);

impl Winding {
    pub fn new(tree: &Tree) -> Self {
        let nothing = Moments {
            centre: DVec3::ZERO,
            area: 0.0,
            dipole: DVec3::ZERO,
            far_squared: 0.0,
        };
        let mut all = vec![nothing; tree.nodes.len()];
        // Children come behind their parents.
        for (i, node) in tree.nodes.iter().enumerate().rev() {
            let mut parts: Vec<Moments> = Vec::with_capacity(4);
            if node.count > 0 {
                let range = node.start as usize..(node.start + node.count) as usize;
                parts.extend(tree.corners[range].iter().map(|&[a, b, c]| {
                    let dipole = (b - a).cross(c - a) / 2.0;
                    Moments {
                        centre: (a + b + c) / 3.0,
                        area: dipole.length(),
                        dipole,
                        ..nothing
                    }
                }));
            } else {
                parts.extend([all[i + 1], all[node.start as usize]]);
            }
            let area: f64 = parts.iter().map(|part| part.area).sum();
            let weighted: DVec3 = parts.iter().map(|part| part.centre * part.area).sum();
            // Areas may be too small for float64; a centre that is no number would make all nodes above near ones.
            let centre = if area > 0.0 {
                weighted / area
            } else {
                node.lo.midpoint(node.hi)
            };
            let corner = (node.hi - centre).max(centre - node.lo);
            all[i] = Moments {
                centre,
                area,
                dipole: parts.iter().map(|part| part.dipole).sum(),
                far_squared: corner.length_squared() * FAR * FAR,
            };
        }
        Self(all)
    }

    /// The winding number at `p`.
    pub fn at(&self, tree: &Tree, p: DVec3) -> f64 {
        let mut stack = [0_u32; 64];
        let mut top = 1;
        let mut sum = 0.0;
        while top > 0 {
            top -= 1;
            let at = stack[top];
            let moments = &self.0[at as usize];
            let r = moments.centre - p;
            let squared = r.length_squared();
            if squared > moments.far_squared {
                sum += moments.dipole.dot(r) / (squared * squared.sqrt());
                continue;
            }
            let node = &tree.nodes[at as usize];
            if node.count > 0 {
                for triangle in node.start..node.start + node.count {
                    sum += solid_angle(p, &tree.corners[triangle as usize]);
                }
            } else {
                stack[top] = node.start;
                stack[top + 1] = at + 1;
                top += 2;
            }
        }
        sum / (4.0 * PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_without_an_area_in_float64_spoil_no_node() {
        let corners = |at: f64, size: f64| {
            let corner = DVec3::splat(at);
            [corner, corner + DVec3::X * size, corner + DVec3::Y * size]
        };
        // The tiny ones at 0 have a node of their own.
        let sizes = [1e-170; 8].into_iter().chain([1.0; 8]);
        let triangles: Vec<[DVec3; 3]> = (0..)
            .zip(sizes)
            .map(|(i, size)| corners(f64::from(i / 8), size))
            .collect();
        let tree = Tree::new(&triangles);
        let Winding(nodes) = Winding::new(&tree);
        assert!(nodes.iter().any(|node| node.area == 0.0));
        assert!(nodes.iter().all(|node| node.centre.is_finite()));
    }

    #[test]
    fn sums_from_afar_are_those_of_all_solid_angles() {
        // A bowl: a ball without its top, of 24×40 pieces.
        let point = |i: i32, j: i32| {
            let (polar, around) = (
                PI - f64::from(i) / 24.0 * 2.2,
                f64::from(j) / 40.0 * 2.0 * PI,
            );
            let (sin, cos) = polar.sin_cos();
            DVec3::new(sin * around.cos(), sin * around.sin(), cos)
        };
        let mut triangles = Vec::new();
        for (i, j) in (0..24).flat_map(|i| (0..40).map(move |j| (i, j))) {
            let (a, b, c, d) = (
                point(i, j),
                point(i, j + 1),
                point(i + 1, j + 1),
                point(i + 1, j),
            );
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        let tree = Tree::new(&triangles);
        let winding = Winding::new(&tree);
        let (mut worst, mut inside) = (0.0_f64, 0);
        for i in 0..1000 {
            let at = DVec3::new(
                f64::from(i % 10),
                f64::from(i / 10 % 10),
                f64::from(i / 100),
            );
            let p = (at - 4.43) * 0.4;
            let each = triangles.iter().map(|corners| solid_angle(p, corners));
            let want = each.sum::<f64>() / (4.0 * PI);
            worst = worst.max((winding.at(&tree, p) - want).abs());
            inside += i32::from(want > 0.5);
        }
        assert!(worst < 0.015, "{worst}");
        assert!(worst > 1e-6, "nothing was far");
        assert!((40..100).contains(&inside), "{inside}");
    }
}
