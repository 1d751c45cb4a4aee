//! A tree of boxes over triangles, and the nearest point of all of them.
//!
//! Split at the median of the centres along their widest axis, down to leaves of a few triangles, which are stored in
//! the order of the leaves. The search for a nearest point visits the nearer child first, and starts from a bound
//! that the caller knows: the triangle that was nearest to the voxel before. (Existing crates of such trees take no
//! bound, or do not tell on which edge or corner the point lies; the winding numbers need moments in the nodes too.)

use glam::DVec3;

use crate::triangle::{self, Feature};

const LEAF: usize = 4;
/// Deeper than any tree that halves fewer than 2³² triangles, with one left over per level.
const STACK: usize = 64;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub lo: DVec3,
    pub hi: DVec3,
    /// First triangle of a leaf; the second child of other nodes (the first one follows its parent).
    pub start: u32,
    /// Triangles of a leaf; 0 for other nodes.
    pub count: u32,
}

pub(crate) struct Tree {
    pub nodes: Vec<Node>,
    /// Corners of the triangles in the order of the leaves.
    pub corners: Vec<[DVec3; 3]>,
    /// Number that each of them had in the mesh.
    pub numbers: Vec<u32>,
}

/// The nearest point of a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    pub point: DVec3,
    pub squared: f64,
    /// In the order of the tree.
    pub triangle: u32,
    pub feature: Feature,
}

impl Node {
    fn squared_distance(&self, p: DVec3) -> f64 {
        (self.lo - p)
            .max(p - self.hi)
            .max(DVec3::ZERO)
            .length_squared()
    }
}

impl Tree {
    /// A tree over at least one triangle.
    pub fn new(triangles: &[[DVec3; 3]]) -> Self {
        let centres: Vec<DVec3> = triangles
            .iter()
            .map(|corners| corners.iter().sum::<DVec3>() / 3.0)
            .collect();
        let mut numbers: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = Vec::with_capacity(triangles.len());
        split(&mut nodes, triangles, &centres, &mut numbers, 0);
        let corners = numbers.iter().map(|&i| triangles[i as usize]).collect();
        Self {
            nodes,
            corners,
            numbers,
        }
    }

    /// The nearest point; `guess` is a triangle (in the order of the tree) that may be near.
    pub fn nearest(&self, p: DVec3, guess: u32) -> Nearest {
        let mut best = self.on_triangle(p, guess);
        self.improve(p, &mut best);
        best
    }

    /// The nearest point, if one is closer than the square root of `limit`.
    pub fn nearest_within(&self, p: DVec3, guess: u32, limit: f64) -> Option<Nearest> {
        let mut best = self.on_triangle(p, guess);
        if best.squared >= limit {
            best.squared = limit;
            best.triangle = u32::MAX;
        }
        self.improve(p, &mut best);
        (best.triangle != u32::MAX).then_some(best)
    }

    fn on_triangle(&self, p: DVec3, triangle: u32) -> Nearest {
        let (point, feature) = triangle::nearest(p, &self.corners[triangle as usize]);
        Nearest {
            point,
            squared: point.distance_squared(p),
            triangle,
            feature,
        }
    }

    fn improve(&self, p: DVec3, best: &mut Nearest) {
        let mut stack = [(0_u32, 0.0_f64); STACK];
        let mut top = 0;
        let mut at = 0_u32;
        if self.nodes[0].squared_distance(p) >= best.squared {
            return;
        }
        loop {
            let node = &self.nodes[at as usize];
            if node.count > 0 {
                for triangle in node.start..node.start + node.count {
                    let found = self.on_triangle(p, triangle);
                    if found.squared < best.squared {
                        *best = found;
                    }
                }
            } else {
                let (mut near, mut far) = (at + 1, node.start);
                let mut near_squared = self.nodes[near as usize].squared_distance(p);
                let mut far_squared = self.nodes[far as usize].squared_distance(p);
                if far_squared < near_squared {
                    std::mem::swap(&mut near, &mut far);
                    std::mem::swap(&mut near_squared, &mut far_squared);
                }
                if far_squared < best.squared {
                    stack[top] = (far, far_squared);
                    top += 1;
                }
                if near_squared < best.squared {
                    at = near;
                    continue;
                }
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                if stack[top].1 < best.squared {
                    at = stack[top].0;
                    break;
                }
            }
        }
    }
}

fn split(
    nodes: &mut Vec<Node>,
    triangles: &[[DVec3; 3]],
    centres: &[DVec3],
    numbers: &mut [u32],
    start: usize,
) {
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let grow = |(lo, hi): (DVec3, DVec3), p: DVec3| (lo.min(p), hi.max(p));
    let (lo, hi) = numbers
        .iter()
        .flat_map(|&i| triangles[i as usize])
        .fold(nothing, grow);
    let at = nodes.len();
    nodes.push(Node {
        lo,
        hi,
        start: start as u32,
        count: numbers.len() as u32,
    });
    if numbers.len() <= LEAF {
        return;
    }
    let (lo, hi) = numbers
        .iter()
        .map(|&i| centres[i as usize])
        .fold(nothing, grow);
    let axis = (hi - lo).max_position();
    let half = numbers.len() / 2;
    numbers.select_nth_unstable_by(half, |&a, &b| {
        centres[a as usize][axis].total_cmp(&centres[b as usize][axis])
    });
    let (below, above) = numbers.split_at_mut(half);
    split(nodes, triangles, centres, below, start);
    nodes[at].start = nodes.len() as u32;
    nodes[at].count = 0;
    split(nodes, triangles, centres, above, start + half);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that look random, the same each time.
    pub(crate) fn random(seed: &mut u64) -> f64 {
        *seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (*seed >> 11) as f64 / (1_u64 << 53) as f64
    }

    #[test]
    fn the_tree_finds_what_a_search_of_all_triangles_finds() {
        let mut seed = 1;
        let mut point = |scale: f64| {
            DVec3::new(random(&mut seed), random(&mut seed), random(&mut seed)) * scale
        };
        let triangles: Vec<[DVec3; 3]> = (0..500)
            .map(|_| {
                let middle = point(1.0);
                [(); 3].map(|()| middle + point(0.2))
            })
            .collect();
        let tree = Tree::new(&triangles);
        let mut guess = 0;
        for _ in 0..500 {
            let p = point(2.0) - 0.5;
            let each = triangles
                .iter()
                .map(|corners| triangle::nearest(p, corners).0.distance_squared(p));
            let want = each.fold(f64::INFINITY, f64::min);
            let got = tree.nearest(p, guess);
            assert_eq!(got.squared, want);
            guess = got.triangle;
            let within = |limit: f64| tree.nearest_within(p, guess / 2, limit);
            assert_eq!(within(want * 1.01).map(|near| near.squared), Some(want));
            assert!(within(want).is_none());
        }
        // Every triangle is in one leaf.
        let mut numbers = tree.numbers.clone();
        numbers.sort_unstable();
        assert!(numbers.iter().copied().eq(0..500));
    }
}
