//! Which bricks a picture needs: the leaves of a tree over the levels.
//!
//! The tree grows from its top. Of all leaves the one is split whose error weighs most, by the estimate of [`Sight`] and by the
//! pixels that it covers; a leaf out of view, one in which nothing is seen, one that is right enough or fine enough stays.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;
use volgraph_formats::bricks::BrickStore;
use volgraph_graph::{Lens, View};

use super::sight::Sight;
use super::stream::Brick;
use crate::source::bricks::Effort;

/// In which bricks something is seen.
#[derive(Debug)]
pub(super) struct Seen {
    /// Of the finest level: in the brick itself.
    pub own: Vec<bool>,
    /// Of each level: in it or beside it, where walks take their first and last segments.
    around: Vec<Vec<bool>>,
}

impl Seen {
    /// By whether something is seen of a range of scalars. Where scalars are made of voxels farther away than the brick's
    /// apron, it is seen in those beside a brick as well.
    pub fn new(store: &BrickStore, sees: impl Fn(f64, f64) -> bool, reaches_far: bool) -> Self {
        let levels = store.levels();
        let dims = levels[0].bricks;
        let each = |level: usize| {
            let [x, y, z] = levels[level].bricks;
            (0..z).flat_map(move |k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])))
        };
        let ranges = each(0).map(|at| store.brick_info(0, at));
        let mut own: Vec<bool> = ranges
            .map(|info| info.is_none_or(|info| sees(info.min, info.max)))
            .collect();
        if reaches_far {
            own = beside(own, dims);
        }
        let fine = beside(own.clone(), dims);
        let mut around = vec![fine];
        for level in 1..levels.len() {
            let (coarse, finer) = (levels[level].bricks, levels[level - 1].bricks);
            let mut row = vec![false; coarse.map(|n| n as usize).iter().product()];
            for (number, at) in each(level - 1).enumerate() {
                row[index(coarse, at.map(|n| n / 2))] |= around[level - 1][number];
            }
            debug_assert!(finer.iter().zip(coarse).all(|(f, c)| f.div_ceil(2) == c));
            around.push(row);
        }
        Self { own, around }
    }

    fn is_around(&self, store: &BrickStore, brick: Brick) -> bool {
        self.around[brick.level][index(store.levels()[brick.level].bricks, brick.at)]
    }
}

/// The same for bricks and all 26 beside each.
fn beside(mut bricks: Vec<bool>, dims: [u32; 3]) -> Vec<bool> {
    for axis in 0..3 {
        let before = bricks.clone();
        let stride = stride(dims, axis);
        for (number, brick) in bricks.iter_mut().enumerate() {
            let at = number / stride % dims[axis] as usize;
            *brick |= at > 0 && before[number - stride];
            *brick |= at + 1 < dims[axis] as usize && before[number + stride];
        }
    }
    bricks
}

fn stride(dims: [u32; 3], axis: usize) -> usize {
    dims[..axis].iter().map(|n| *n as usize).product()
}

/// The number of a brick among those of its level.
pub(super) fn index(dims: [u32; 3], at: [u32; 3]) -> usize {
    (0..3)
        .map(|axis| at[axis] as usize * stride(dims, axis))
        .sum()
}

/// What a picture needs.
#[derive(Debug, Default)]
pub(super) struct Target {
    /// The bricks that it is made of.
    pub leaves: Vec<Brick>,
    /// All bricks of the tree, coarse ones first, then those that matter most: in which order they are read.
    pub all: Vec<Brick>,
    /// The estimated error of the picture, in the root mean square over its pixels.
    pub error: f64,
    /// Whether the pool is too small for the tolerance.
    pub is_cut: bool,
}

/// What a target is made for.
pub(super) struct Aim<'a> {
    pub store: &'a BrickStore,
    pub effort: Effort,
    /// Most bricks.
    pub room: usize,
    pub view: Option<View>,
    pub seen: &'a Seen,
    /// How wrong a picture is by what scalars are wrong; where it is not known, errors count in parts of the range.
    pub sight: Option<&'a Sight>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Leaf {
    /// What it would be worth to split it; nothing where it stays.
    weight: f64,
    /// Squares of estimated errors, summed over pixels.
    squares: f64,
    brick: Brick,
}

impl Eq for Leaf {}

impl PartialOrd for Leaf {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Leaf {
    fn cmp(&self, other: &Self) -> Ordering {
        // Ties are told apart, so that the same picture is always made of the same bricks.
        let order = self.weight.total_cmp(&other.weight);
        order.then_with(|| other.brick.cmp(&self.brick))
    }
}

impl Aim<'_> {
    /// The bricks of the picture.
    pub fn target(&self) -> Target {
        let top = self.store.levels().len() - 1;
        let mut heap = BinaryHeap::from([self.leaf(Brick {
            level: top,
            at: [0; 3],
        })]);
        let (mut leaves, mut split, mut count) = (Vec::new(), Vec::new(), 1);
        let mut is_cut = false;
        while let Some(leaf) = heap.pop() {
            if leaf.weight <= 0.0 || is_cut {
                leaves.push(leaf);
                continue;
            }
            let children = self.children(leaf.brick);
            if count + children.len() > self.room {
                is_cut = true;
                leaves.push(leaf);
                continue;
            }
            count += children.len();
            split.push(leaf);
            heap.extend(children.into_iter().map(|brick| self.leaf(brick)));
        }
        let squares: f64 = leaves.iter().map(|leaf| leaf.squares).sum();
        let pixels = self
            .view
            .map_or(1.0, |view| view.size.map(f64::from).iter().product());
        let error = (squares / pixels).sqrt().min(1.0);
        let mut all: Vec<Leaf> = leaves.iter().chain(&split).copied().collect();
        all.sort_by(|a, b| b.brick.level.cmp(&a.brick.level).then_with(|| b.cmp(a)));
        let bricks = |leaves: Vec<Leaf>| leaves.into_iter().map(|leaf| leaf.brick).collect();
        Target {
            leaves: bricks(leaves),
            all: bricks(all),
            error,
            is_cut,
        }
    }

    fn children(&self, brick: Brick) -> Vec<Brick> {
        let level = brick.level - 1;
        let dims = self.store.levels()[level].bricks;
        let pair = |axis: usize| {
            let first = 2 * brick.at[axis];
            first..(first + 2).min(dims[axis])
        };
        let mut children = Vec::with_capacity(8);
        for z in pair(2) {
            for y in pair(1) {
                children.extend(pair(0).map(|x| Brick {
                    level,
                    at: [x, y, z],
                }));
            }
        }
        children
    }

    /// A leaf with what is known of it.
    fn leaf(&self, brick: Brick) -> Leaf {
        let stays = |squares: f64| Leaf {
            weight: 0.0,
            squares,
            brick,
        };
        let (level, edge) = (&self.store.levels()[brick.level], self.store.edge());
        let Some(info) = self.store.brick_info(brick.level, brick.at) else {
            return stays(0.0);
        };
        if brick.level == 0 || !self.seen.is_around(self.store, brick) {
            return stays(0.0);
        }
        let voxel = level.grid.min_spacing();
        let thickness = f64::from(edge) * voxel;
        let range = (info.min, info.max);
        let error = match self.sight {
            Some(sight) => sight.error(range, info.rms_error, thickness, f64::from(edge)),
            None => {
                let (low, high) = self.store.statistics().range().unwrap_or((0.0, 1.0));
                let span = high - low;
                if span > 0.0 {
                    info.rms_error / span
                } else {
                    0.0
                }
            }
        };
        // Half a voxel is where the outermost samples reach.
        let corner = |high: [bool; 3]| -> DVec3 {
            let at = |axis: usize| {
                let first = brick.at[axis] * edge;
                let last = (first + edge).min(level.grid.dims[axis]);
                f64::from(if high[axis] { last } else { first }) - 0.5
            };
            let index = DVec3::new(at(0), at(1), at(2));
            level.grid.world_from_index.transform_point3(index)
        };
        let corners: [DVec3; 8] =
            std::array::from_fn(|i| corner([i & 1 != 0, i & 2 != 0, i & 4 != 0]));
        let (area, is_fine) = match &self.view {
            None => (1.0, false),
            Some(view) => {
                let Some([_, _, width, height]) = view.pixel_bounds(&corners) else {
                    return stays(0.0);
                };
                let is_fine = voxel <= self.effort.pixels * pixel(view, &corners);
                (f64::from(width) * f64::from(height), is_fine)
            }
        };
        let squares = error * error * area;
        // Without a tolerance all counts that is not exact.
        let is_right = error <= self.effort.tolerance
            && (self.effort.tolerance > 0.0 || info.max_error == 0.0);
        if is_fine || is_right || brick.level <= self.effort.finest {
            return stays(squares);
        }
        Leaf {
            // What has no error by estimate, and some in truth, comes last.
            weight: squares.max(f64::MIN_POSITIVE),
            squares,
            brick,
        }
    }
}

/// World size of a pixel where a box is nearest to the eye; 0 where the eye may be in it.
fn pixel(view: &View, corners: &[DVec3; 8]) -> f64 {
    let Lens {
        size,
        half_extent,
        is_orthographic,
        ..
    } = view.lens();
    let across = 2.0 * half_extent[1] / f64::from(size[1].max(1));
    if is_orthographic {
        return across;
    }
    let depth = corners
        .iter()
        .map(|corner| (*corner - view.camera.eye).dot(view.camera.forward));
    across * depth.fold(f64::INFINITY, f64::min).max(0.0)
}
