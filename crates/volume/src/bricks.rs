//! The least and the largest scalar in bricks of a volume: what a walk need not look at.
//!
//! A brick is a cube of so many voxels along each edge; the last ones along an axis may be cut off. Its range is that of
//! all voxels that scalars inside of it are made of: with margins of voxels before and behind it, clamped to the grid. A
//! brick that goes from voxel centre to voxel centre needs one voxel less before it than one that goes from face to face.

use std::ops::Range;

use rayon::prelude::*;

use crate::{Volume, Voxels};

/// Ranges of the bricks of a volume.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickRanges {
    /// Bricks along each axis.
    pub dims: [u32; 3],
    /// Least and largest data value of each, x fastest; what is not finite as [`Volume::drawn`] says.
    pub ranges: Vec<[f64; 2]>,
}

/// Bricks along each axis of a grid.
#[must_use]
pub fn brick_dims(dims: [u32; 3], edge: u32) -> [u32; 3] {
    dims.map(|n| n.div_ceil(edge.max(1)))
}

impl Volume {
    /// The ranges of its bricks of `edge` voxels, with so many voxels before and behind them along each axis.
    #[must_use]
    pub fn brick_ranges(&self, edge: u32, margin: [u32; 2]) -> BrickRanges {
        let dims = brick_dims(self.grid().dims, edge);
        let ranges = self.brick_ranges_of(edge, margin, 0..dims[2]);
        BrickRanges { dims, ranges }
    }

    /// Those of some layers of bricks along z.
    #[must_use]
    pub fn brick_ranges_of(
        &self,
        edge: u32,
        margin: [u32; 2],
        layers: Range<u32>,
    ) -> Vec<[f64; 2]> {
        let bricks = Bricks {
            dims: self.grid().dims.map(|n| n as usize),
            edge: edge.max(1) as usize,
            margin: margin.map(|voxels| voxels as usize),
            layers: layers.start as usize..layers.end as usize,
        };
        match self.voxels() {
            Voxels::U8(values) => bricks.ranges(values, |value| value, f64::from),
            Voxels::I8(values) => bricks.ranges(values, |value| value, f64::from),
            Voxels::U16(values) => bricks.ranges(values, |value| value, f64::from),
            Voxels::I16(values) => bricks.ranges(values, |value| value, f64::from),
            Voxels::U32(values) => bricks.ranges(values, |value| value, f64::from),
            Voxels::I32(values) => bricks.ranges(values, |value| value, f64::from),
            Voxels::F32(values) => {
                bricks.ranges(values, |value| self.drawn(f64::from(value)), |value| value)
            }
            Voxels::U64(values) => bricks.ranges(values, |value| value, |value| value as f64),
            Voxels::I64(values) => bricks.ranges(values, |value| value, |value| value as f64),
            Voxels::F64(values) => bricks.ranges(values, |value| self.drawn(value), |value| value),
        }
    }
}

struct Bricks {
    /// Voxels along each axis of the grid.
    dims: [usize; 3],
    edge: usize,
    margin: [usize; 2],
    /// Of bricks, along z.
    layers: Range<usize>,
}

impl Bricks {
    /// The voxels along an axis that a brick's scalars are made of.
    fn reach(&self, brick: usize, axis: usize) -> Range<usize> {
        let start = brick * self.edge;
        let [before, behind] = self.margin;
        start.saturating_sub(before)..(start + self.edge + behind).min(self.dims[axis])
    }

    fn ranges<S: Copy + Sync, T: Copy + PartialOrd>(
        &self,
        values: &[S],
        read: impl Fn(S) -> T + Sync,
        number: impl Fn(T) -> f64 + Sync,
    ) -> Vec<[f64; 2]> {
        let [nx, ny, _] = self.dims;
        let [bx, by, _] = self.dims.map(|n| n.div_ceil(self.edge));
        let row = |at: usize| {
            // Over the row's cross-section first, then along it.
            let mut low: Vec<T> = Vec::new();
            let mut high: Vec<T> = Vec::new();
            for z in self.reach(at / by, 2) {
                for y in self.reach(at % by, 1) {
                    let line = values[(z * ny + y) * nx..][..nx].iter().map(|it| read(*it));
                    if low.is_empty() {
                        low.extend(line);
                        high.clone_from(&low);
                        continue;
                    }
                    for ((low, high), value) in low.iter_mut().zip(&mut high).zip(line) {
                        *low = if value < *low { value } else { *low };
                        *high = if value > *high { value } else { *high };
                    }
                }
            }
            let range = |x: usize| {
                let lows = low[self.reach(x, 0)].iter().map(|it| number(*it));
                let highs = high[self.reach(x, 0)].iter().map(|it| number(*it));
                [
                    lows.fold(f64::INFINITY, f64::min),
                    highs.fold(f64::NEG_INFINITY, f64::max),
                ]
            };
            (0..bx).map(range).collect::<Vec<_>>()
        };
        let rows = self.layers.start * by..self.layers.end * by;
        rows.into_par_iter().flat_map_iter(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::Grid;

    #[test]
    fn ranges_are_those_of_the_voxels_in_and_around_a_brick() {
        let dims = [11_u32, 5, 8];
        let mut state = 7_u32;
        let values: Vec<f32> = (0..dims.iter().product::<u32>())
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 16) as f32
            })
            .collect();
        let grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO);
        let volume = Volume::new("v", grid, Voxels::F32(values)).unwrap();
        for (edge, margin) in [(4, [1, 1]), (3, [1, 2]), (16, [0, 1]), (1, [0, 0])] {
            let found = volume.brick_ranges(edge, margin);
            assert_eq!(found.dims, dims.map(|n| n.div_ceil(edge)));
            let mut at = 0;
            for z in 0..found.dims[2] {
                for y in 0..found.dims[1] {
                    for x in 0..found.dims[0] {
                        let near = |voxel: u32, brick: u32| {
                            (brick * edge).saturating_sub(margin[0]) <= voxel
                                && voxel < brick * edge + edge + margin[1]
                        };
                        let mut expected = [f64::INFINITY, f64::NEG_INFINITY];
                        for k in (0..dims[2]).filter(|k| near(*k, z)) {
                            for j in (0..dims[1]).filter(|j| near(*j, y)) {
                                for i in (0..dims[0]).filter(|i| near(*i, x)) {
                                    let value = volume.voxel([i, j, k]);
                                    expected = [expected[0].min(value), expected[1].max(value)];
                                }
                            }
                        }
                        assert_eq!(found.ranges[at], expected, "{x} {y} {z} of {edge}");
                        at += 1;
                    }
                }
            }
        }
    }

    #[test]
    fn layer_by_layer_is_the_same_as_all_at_once() {
        let dims = [9, 6, 11];
        let values: Vec<u16> = (0..9 * 6 * 11).map(|i| (i * 7919 % 1000) as u16).collect();
        let grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO);
        let volume = Volume::new("v", grid, values.into()).unwrap();
        for (edge, margin) in [(1, [0, 0]), (4, [1, 1]), (4, [1, 2]), (16, [1, 1])] {
            let whole = volume.brick_ranges(edge, margin);
            let details = volume.brick_details(edge, margin[1]);
            let layers = brick_dims(dims, edge)[2];
            let of_layers =
                (0..layers).flat_map(|z| volume.brick_ranges_of(edge, margin, z..z + 1));
            assert!(of_layers.eq(whole.ranges), "ranges of {edge}");
            let of_layers =
                (0..layers).flat_map(|z| volume.brick_details_of(edge, margin[1], z..z + 1));
            assert!(of_layers.eq(details.details), "details of {edge}");
        }
    }
}
