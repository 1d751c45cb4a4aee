//! How fast scalars change in bricks of a volume: how long the segments of a walk may be.
//!
//! Of the trilinear field, or one that is smoother (cubic B-splines of the voxels): its gradient anywhere in a brick is a
//! mean of differences of neighbouring voxels, and its second derivative, kinks at the faces of cells included, one of
//! second differences. So the largest of these bound both.

use std::ops::Range;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::bricks::brick_dims;
use crate::{Volume, Voxels};

/// Bounds of the derivatives in the bricks of a volume.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickDetails {
    /// Bricks along each axis.
    pub dims: [u32; 3],
    /// Of each, x fastest: the largest change of the scalar along any direction, in data units per world unit; and the
    /// largest change of that along the same direction, per world unit once more. What is not finite as
    /// [`Volume::drawn`] says.
    pub details: Vec<[f64; 2]>,
}

impl Volume {
    /// How fast scalars change in bricks of `edge` voxels, as far as voxels `margin` beside them are read.
    #[must_use]
    pub fn brick_details(&self, edge: u32, margin: u32) -> BrickDetails {
        let dims = brick_dims(self.grid().dims, edge);
        let details = self.brick_details_of(edge, margin, 0..dims[2]);
        BrickDetails { dims, details }
    }

    /// Those of some layers of bricks along z.
    #[must_use]
    pub fn brick_details_of(&self, edge: u32, margin: u32, layers: Range<u32>) -> Vec<[f64; 2]> {
        let bricks = Bricks {
            dims: self.grid().dims.map(|n| n as usize),
            edge: edge.max(1) as usize,
            margin: margin.max(1) as usize,
            layers: layers.start as usize..layers.end as usize,
            units: units(self.grid().world_from_index.matrix3),
        };
        match self.voxels() {
            Voxels::U8(values) => bricks.details(values, f64::from),
            Voxels::I8(values) => bricks.details(values, f64::from),
            Voxels::U16(values) => bricks.details(values, f64::from),
            Voxels::I16(values) => bricks.details(values, f64::from),
            Voxels::U32(values) => bricks.details(values, f64::from),
            Voxels::I32(values) => bricks.details(values, f64::from),
            Voxels::F32(values) => bricks.details(values, |value| self.drawn(f64::from(value))),
            Voxels::U64(values) => bricks.details(values, |value| value as f64),
            Voxels::I64(values) => bricks.details(values, |value| value as f64),
            Voxels::F64(values) => bricks.details(values, |value| self.drawn(value)),
        }
    }
}

/// Most index units along each axis in a world unit, so that bounds along the axes are bounds along any direction: of
/// a grid with right angles by the lengths of its axes, of others times the root of 3, for its directions add up.
fn units(world_from_index: DMat3) -> DVec3 {
    let [x, y, z] = [
        world_from_index.x_axis,
        world_from_index.y_axis,
        world_from_index.z_axis,
    ];
    let is_right = |a: DVec3, b: DVec3| a.dot(b).abs() <= 1e-9 * a.length() * b.length();
    if is_right(x, y) && is_right(y, z) && is_right(z, x) {
        return DVec3::new(x.length(), y.length(), z.length()).recip();
    }
    let rows = world_from_index.inverse().transpose();
    let lengths = [rows.x_axis, rows.y_axis, rows.z_axis].map(DVec3::length);
    DVec3::from_array(lengths) * 3_f64.sqrt()
}

struct Bricks {
    /// Voxels along each axis of the grid.
    dims: [usize; 3],
    edge: usize,
    margin: usize,
    /// Of bricks, along z.
    layers: Range<usize>,
    units: DVec3,
}

/// The largest differences of a brick: along x, y, z; second ones; mixed ones of yz, xz, xy.
#[derive(Clone, Copy, Default)]
struct Differences {
    first: [f64; 3],
    second: [f64; 3],
    mixed: [f64; 3],
}

impl Bricks {
    /// The first voxel, and the one behind the last, whose cells a brick along an axis reaches into.
    fn reach(&self, brick: usize, axis: usize) -> (usize, usize) {
        let start = brick * self.edge;
        let end = (start + self.edge + self.margin).min(self.dims[axis]);
        (start.saturating_sub(self.margin), end)
    }

    fn details<S: Copy + Sync>(
        &self,
        values: &[S],
        number: impl Fn(S) -> f64 + Sync,
    ) -> Vec<[f64; 2]> {
        let [bx, by, _] = self.dims.map(|n| n.div_ceil(self.edge));
        let at = |x: usize, y: usize, z: usize| {
            number(values[(z * self.dims[1] + y) * self.dims[0] + x])
        };
        (self.layers.start * by..self.layers.end * by)
            .into_par_iter()
            .flat_map_iter(|row| {
                let mut found = vec![Differences::default(); bx];
                let (y_start, y_end) = self.reach(row % by, 1);
                let (z_start, z_end) = self.reach(row / by, 2);
                let nx = self.dims[0];
                for z in z_start..z_end {
                    for y in y_start..y_end {
                        for x in 0..nx {
                            let here = at(x, y, z);
                            let after = |is: bool, dx, dy, dz| {
                                if is { at(x + dx, y + dy, z + dz) } else { here }
                            };
                            let (has_x, has_y, has_z) = (x + 1 < nx, y + 1 < y_end, z + 1 < z_end);
                            let [ax, ay, az] = [
                                after(has_x, 1, 0, 0),
                                after(has_y, 0, 1, 0),
                                after(has_z, 0, 0, 1),
                            ];
                            let first = [ax - here, ay - here, az - here].map(f64::abs);
                            let bend = |is: bool, after: f64, dx, dy, dz| {
                                if is {
                                    (after - 2.0 * here + at(x - dx, y - dy, z - dz)).abs()
                                } else {
                                    0.0
                                }
                            };
                            let second = [
                                bend(has_x && x > 0, ax, 1, 0, 0),
                                bend(has_y && y > y_start, ay, 0, 1, 0),
                                bend(has_z && z > z_start, az, 0, 0, 1),
                            ];
                            let twist = |is: bool, a: f64, b: f64, dx, dy, dz| {
                                if is {
                                    (at(x + dx, y + dy, z + dz) - a - b + here).abs()
                                } else {
                                    0.0
                                }
                            };
                            let mixed = [
                                twist(has_y && has_z, ay, az, 0, 1, 1),
                                twist(has_x && has_z, ax, az, 1, 0, 1),
                                twist(has_x && has_y, ax, ay, 1, 1, 0),
                            ];
                            // The bricks that reach from here to the next voxel; and from the one before.
                            let low = (x + 2).saturating_sub(self.edge + self.margin);
                            let low = low.div_ceil(self.edge).min(bx - 1);
                            let high = ((x + self.margin) / self.edge).min(bx - 1);
                            let before = (x + self.margin - 1) / self.edge;
                            for (brick, found) in found[low..=high].iter_mut().enumerate() {
                                larger(&mut found.first, &first);
                                larger(&mut found.mixed, &mixed);
                                if low + brick <= before {
                                    larger(&mut found.second, &second);
                                }
                            }
                        }
                    }
                }
                found.into_iter().map(|it| it.bounds(self.units))
            })
            .collect()
    }
}

fn larger(a: &mut [f64; 3], b: &[f64; 3]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = a.max(*b);
    }
}

impl Differences {
    /// The length of the gradient, and the Frobenius norm of the second derivatives: along any direction there is less.
    fn bounds(&self, units: DVec3) -> [f64; 2] {
        let first = DVec3::from_array(self.first) * units;
        let second = DVec3::from_array(self.second) * units * units;
        let others = DVec3::new(units.y * units.z, units.x * units.z, units.x * units.y);
        let mixed = DVec3::from_array(self.mixed) * others;
        let squares = second.length_squared() + 2.0 * mixed.length_squared();
        [first.length(), squares.sqrt()]
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use crate::{Grid, Volume, Voxels};

    /// Voxels of a function of their index.
    fn volume(dims: [u32; 3], spacing: DVec3, value: impl Fn(DVec3) -> f64) -> Volume {
        let mut values = Vec::new();
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                for x in 0..dims[0] {
                    values.push(value(DVec3::new(x.into(), y.into(), z.into())) as f32);
                }
            }
        }
        let grid = Grid::axis_aligned(dims, spacing, DVec3::ZERO);
        Volume::new("v", grid, Voxels::F32(values)).unwrap()
    }

    #[test]
    fn a_linear_field_has_its_gradient_and_no_second_derivative() {
        let spacing = DVec3::new(0.5, 1.0, 2.0);
        let slope = DVec3::new(3.0, -4.0, 12.0);
        let volume = volume([9, 7, 6], spacing, |at| slope.dot(at * spacing));
        let found = volume.brick_details(4, 1);
        assert_eq!(found.dims, [3, 2, 2]);
        for [first, second] in found.details {
            assert!((first - 13.0).abs() < 1e-5, "{first}");
            assert!(second < 1e-5, "{second}");
        }
    }

    #[test]
    fn derivatives_of_what_is_in_a_brick_are_in_its_bounds_and_those_far_away_are_not() {
        // The second derivative of a bump along x that only the brick in the middle has.
        let volume = volume([12, 4, 4], DVec3::ONE, |at| {
            f64::from(u8::from((5.0..6.5).contains(&at.x)))
        });
        let found = volume.brick_details(4, 1).details;
        assert_eq!(found[1], [1.0, 1.0]);
        assert_eq!(found[2], [0.0, 0.0]);
    }

    #[test]
    fn a_sheared_grid_is_bounded_as_well() {
        let slope = DVec3::new(1.0, 2.0, -1.0);
        let mut grid = Grid::axis_aligned([8, 8, 8], DVec3::ONE, DVec3::ZERO);
        let shear = glam::DMat3::from_cols(
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(0.8, 0.6, 0.0),
            DVec3::new(0.0, 0.6, 0.8),
        );
        grid.world_from_index = DAffine3::from_mat3(shear);
        let mut values = Vec::new();
        for z in 0..8 {
            for y in 0..8 {
                for x in 0..8 {
                    let at = DVec3::new(x.into(), y.into(), z.into());
                    values.push(slope.dot(shear * at) as f32);
                }
            }
        }
        let volume = Volume::new("v", grid, Voxels::F32(values)).unwrap();
        for [first, _] in volume.brick_details(4, 1).details {
            assert!(first >= slope.length() - 1e-4, "{first}");
        }
    }
}
