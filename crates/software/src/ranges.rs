//! Bounds of what is near a point: the least and the largest scalar within so many voxels of it, for several distances.

use rayon::prelude::*;
use volgraph_volume::{ScalarType, Volume};

use crate::grid::VoxelGrid;

/// The ranges of the scalars around bricks, in levels: of each brick and as much again on all sides.
#[derive(Clone, Debug)]
pub struct RangeMap {
    /// From small bricks to one that holds the whole volume.
    pub(crate) levels: Vec<RangeLevel>,
    /// The raw scalar of a bound of 0, and how much larger that of 1 is.
    pub(crate) scalars: (f32, f32),
}

/// Bricks of one size.
#[derive(Clone, Debug)]
pub(crate) struct RangeLevel {
    /// Voxels along the edge of a brick.
    pub(crate) edge: f32,
    /// Bricks to the next row, and to the next layer.
    pub(crate) row: i32,
    pub(crate) layer: i32,
    /// The least scalar in the low half of a word, the largest one in the high half.
    pub(crate) words: Vec<u32>,
}

/// Voxels along the edge of the smallest bricks.
const EDGE: u32 = 2;

/// The same of volumes of more voxels than [`LARGE`], so that maps stay small beside voxels.
const LARGE_EDGE: u32 = 4;
const LARGE: u64 = 1 << 25;

impl RangeMap {
    /// The ranges of a volume, of which the grid is.
    #[must_use]
    pub fn new(volume: &Volume, grid: &VoxelGrid) -> Self {
        let edge = if volume.grid().voxel_count() > LARGE {
            LARGE_EDGE
        } else {
            EDGE
        };
        // What samples between the first voxel of a brick and that of the next are made of.
        let bricks = volume.brick_ranges(edge, [1; 2]);
        let (low, high) = volume.statistics().range().unwrap_or((0.0, 0.0));
        let is_exact = matches!(
            volume.voxels().scalar_type(),
            ScalarType::U8 | ScalarType::I8 | ScalarType::U16 | ScalarType::I16
        );
        // Raw scalars are whole numbers; of others the bounds are rounded outwards, by more than f32 rounds them.
        let (base, unit) = if is_exact {
            (grid.offset, 1.0)
        } else {
            (low, (high - low) * 1.0001 / f64::from(u16::MAX))
        };
        let per_value = if unit > 0.0 { unit.recip() } else { 0.0 };
        let more = if is_exact { 0.0 } else { 1.0 };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to two bytes"
        )]
        let bound = |value: f64| value.clamp(0.0, f64::from(u16::MAX)) as u16;
        let ranges = bricks.ranges.par_iter().map(|[low, high]| {
            let [low, high] = [low, high].map(|value| (value - base) * per_value);
            [bound(low.floor() - more), bound(high.ceil() + more)]
        });
        let mut ranges: Vec<[u16; 2]> = ranges.collect();
        let mut dims = bricks.dims.map(|n| n as usize);
        let mut edge = edge;
        let mut levels = Vec::new();
        loop {
            levels.push(level(&ranges, dims, edge));
            if dims == [1; 3] {
                break;
            }
            (ranges, dims) = halved(&ranges, dims);
            edge = edge.saturating_mul(2);
        }
        #[expect(clippy::cast_possible_truncation, reason = "samples are f32")]
        let scalars = ((base - grid.offset) as f32, unit as f32);
        Self { levels, scalars }
    }
}

fn both([a, b]: [u16; 2], [c, d]: [u16; 2]) -> [u16; 2] {
    [a.min(c), b.max(d)]
}

const NONE: [u16; 2] = [u16::MAX, 0];

/// Of two bricks along each axis one.
fn halved(ranges: &[[u16; 2]], dims: [usize; 3]) -> (Vec<[u16; 2]>, [usize; 3]) {
    let half = dims.map(|n| n.div_ceil(2));
    let mut halved = vec![NONE; half[0] * half[1] * half[2]];
    for (row, ranges) in ranges.chunks_exact(dims[0]).enumerate() {
        let (y, z) = (row % dims[1], row / dims[1]);
        let first = (z / 2 * half[1] + y / 2) * half[0];
        for (x, range) in ranges.iter().enumerate() {
            let to = &mut halved[first + x / 2];
            *to = both(*to, *range);
        }
    }
    (halved, half)
}

/// Bricks with those around them.
fn level(ranges: &[[u16; 2]], dims: [usize; 3], edge: u32) -> RangeLevel {
    let [nx, ny, _] = dims;
    let mut around = ranges.to_vec();
    for (stride, count) in [(1, nx), (nx, ny), (nx * ny, dims[2])] {
        let one = |at: usize| {
            let place = at / stride % count;
            let mut range = around[at];
            if place > 0 {
                range = both(range, around[at - stride]);
            }
            if place + 1 < count {
                range = both(range, around[at + stride]);
            }
            range
        };
        around = (0..around.len()).into_par_iter().map(one).collect();
    }
    let words = around.into_iter();
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        reason = "there are fewer bricks than voxels, which are less than 2^31"
    )]
    RangeLevel {
        edge: edge as f32,
        row: nx as i32,
        layer: (nx * ny) as i32,
        words: words
            .map(|[low, high]| u32::from(low) | u32::from(high) << 16)
            .collect(),
    }
}
