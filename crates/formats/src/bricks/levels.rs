//! Where the samples of the levels lie: dimensions, placement, bricks, and which fine samples make a coarse one.
//!
//! A level has `n.div_ceil(2)` samples along an axis where the finer one has `n`, and its cells share the finer level's
//! box evenly. Where `n` is even a coarse cell is two fine ones; where it is odd it is a little less than two, and a
//! fine cell on the border of two coarse ones counts for both by the length that lies in each. All of that is whole
//! numbers: fine cell `k` of `n` spans `k m .. (k + 1) m` of a box `n m` long, coarse cell `i` of `m` spans
//! `i n .. (i + 1) n`.

use glam::{DAffine3, DMat3, DVec3};
use volgraph_volume::{Grid, brick_dims};

/// A level of a [`BrickStore`](super::BrickStore).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrickLevel {
    /// How many samples there are along each axis, and where their centres are in the world. Cells of all levels
    /// share one box: a point at `p` (0 to 1 along each axis of it) has the index `p * dims - 0.5` on every level.
    pub grid: Grid,
    /// Bricks along x, y and z: `dims.div_ceil(edge)`.
    pub bricks: [u32; 3],
}

/// The levels of a volume, finest first, until one fits a single brick.
pub(super) fn levels(finest: &Grid, edge: u32) -> Vec<BrickLevel> {
    let mut dims = finest.dims;
    let mut levels = vec![level(finest, dims, edge)];
    while dims.iter().any(|&n| n > edge) {
        dims = dims.map(|n| n.div_ceil(2));
        levels.push(level(finest, dims, edge));
    }
    levels
}

fn level(finest: &Grid, dims: [u32; 3], edge: u32) -> BrickLevel {
    BrickLevel {
        grid: coarse(finest, dims),
        bricks: brick_dims(dims, edge),
    }
}

/// The grid of other dimensions whose cells share the box of a grid.
pub(super) fn coarse(finest: &Grid, dims: [u32; 3]) -> Grid {
    if dims == finest.dims {
        return *finest;
    }
    let counts = |dims: [u32; 3]| DVec3::from_array(dims.map(f64::from));
    let step = counts(finest.dims) / counts(dims);
    let world = finest.world_from_index;
    Grid {
        dims,
        world_from_index: DAffine3 {
            matrix3: world.matrix3 * DMat3::from_diagonal(step),
            translation: world.transform_point3((step - 1.0) / 2.0),
        },
        node_centred: false,
    }
}

/// The fine samples that make a coarse one along an axis, and their parts of it, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Taps {
    pub first: u32,
    pub count: u32,
    pub weights: [f64; 3],
}

/// Those of coarse sample `i` of `m` out of `n` fine ones; `m` is `n.div_ceil(2)`.
pub(super) fn taps(i: u32, n: u32, m: u32) -> Taps {
    let [i, n, m] = [i, n, m].map(u64::from);
    let (low, high) = (i * n, (i + 1) * n);
    let (first, last) = (low / m, (high - 1) / m);
    let mut weights = [0.0; 3];
    for (weight, k) in weights.iter_mut().zip(first..=last) {
        let part = high.min((k + 1) * m) - low.max(k * m);
        *weight = part as f64 / n as f64;
    }
    #[expect(clippy::cast_possible_truncation, reason = "indices below n")]
    Taps {
        first: first as u32,
        count: (last - first + 1) as u32,
        weights,
    }
}

/// The first of `n` fine samples whose centre lies in coarse cell `i` of `m` or behind it: the ranges from one coarse
/// cell to the next share all fine samples, each counted once.
pub(super) fn first_in(i: u32, n: u32, m: u32) -> u32 {
    let [i, n, m] = [i, n, m].map(u128::from);
    // (k + 0.5) / n >= i / m.
    let twice = (2 * i * n).saturating_sub(m);
    u32::try_from(twice.div_ceil(2 * m)).unwrap_or(u32::MAX)
}

/// Where the centre of fine sample `k` of `n` lies between the samples of a level of `m`: the lower one of the two, and
/// how far it is to the next; clamped to the outermost samples.
pub(super) fn between(k: u32, n: u32, m: u32) -> (u32, f64) {
    let [wide_k, wide_n, wide_m] = [k, n, m].map(i128::from);
    // ((k + 0.5) m / n - 0.5), over 2 n.
    let place = (2 * wide_k + 1) * wide_m - wide_n;
    if place <= 0 {
        return (0, 0.0);
    }
    let (lower, rest) = (place / (2 * wide_n), place % (2 * wide_n));
    let lower = u32::try_from(lower).unwrap_or(u32::MAX);
    if lower >= m - 1 {
        return (m - 1, 0.0);
    }
    (lower, rest as f64 / (2 * wide_n) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sample_is_lost_and_all_count_the_same() {
        for n in 1..70_u32 {
            let m = n.div_ceil(2);
            let mut sums = vec![0.0; n as usize];
            for i in 0..m {
                let taps = taps(i, n, m);
                let used = &taps.weights[..taps.count as usize];
                assert!((used.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                for (k, weight) in (taps.first..).zip(used) {
                    sums[k as usize] += weight;
                }
            }
            let each = f64::from(m) / f64::from(n);
            assert!(sums.iter().all(|sum| (sum - each).abs() < 1e-15), "{n}");
        }
        assert_eq!(taps(3, 10, 5).weights, [0.5, 0.5, 0.0]);
        assert_eq!(taps(0, 1, 1).weights, [1.0, 0.0, 0.0]);
        assert_eq!((taps(1, 3, 2).first, taps(1, 3, 2).count), (1, 2));
    }

    #[test]
    fn ranges_of_coarse_cells_share_the_fine_samples() {
        for (n, m) in [(10, 5), (7, 4), (7, 1), (100, 13), (1, 1), (9, 9)] {
            assert_eq!((first_in(0, n, m), first_in(m, n, m)), (0, n));
            for i in 0..m {
                for k in first_in(i, n, m)..first_in(i + 1, n, m) {
                    assert_eq!((2 * k + 1) * m / (2 * n), i, "{k} of {n} in {m}");
                }
            }
        }
    }

    #[test]
    fn centres_lie_between_the_coarse_ones() {
        assert_eq!(between(0, 8, 4), (0, 0.0));
        assert_eq!(between(1, 8, 4), (0, 0.25));
        assert_eq!(between(2, 8, 4), (0, 0.75));
        assert_eq!(between(7, 8, 4), (3, 0.0));
        assert_eq!(between(5, 6, 6), (5, 0.0));
        assert_eq!(between(4, 6, 6), (4, 0.0));
    }

    #[test]
    fn coarse_grids_span_the_same_box() {
        let mut grid = Grid::axis_aligned([100, 37, 5], DVec3::new(1.0, 2.0, 3.0), DVec3::ONE);
        grid.world_from_index.matrix3.y_axis = DVec3::new(0.3, -2.0, 0.1);
        let levels = levels(&grid, 8);
        let dims: Vec<_> = levels.iter().map(|level| level.grid.dims).collect();
        assert_eq!(
            dims,
            [
                [100, 37, 5],
                [50, 19, 3],
                [25, 10, 2],
                [13, 5, 1],
                [7, 3, 1]
            ]
        );
        assert_eq!(levels[2].bricks, [4, 2, 1]);
        for level in &levels {
            let pairs = level
                .grid
                .corners_world()
                .into_iter()
                .zip(grid.corners_world());
            for (a, b) in pairs {
                assert!((a - b).length() < 1e-12, "{a} {b}");
            }
        }
    }
}
