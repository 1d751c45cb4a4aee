//! How much neighbouring voxels differ: by how much a trilinear field changes along a ray.

use rayon::prelude::*;

use crate::{Volume, Voxels};

impl Volume {
    /// The largest difference of two voxels beside each other along each axis, in data units; what is not finite as
    /// [`Volume::drawn`] says. The slope of the trilinear field along an axis is a mean of such differences, so it is
    /// never steeper, per voxel. Found once, in one pass.
    #[must_use]
    pub fn steepness(&self) -> [f64; 3] {
        *self.steepness.get_or_init(|| {
            let dims = self.grid().dims.map(|n| n as usize);
            match self.voxels() {
                Voxels::U8(values) => steepest(dims, values, f64::from),
                Voxels::I8(values) => steepest(dims, values, f64::from),
                Voxels::U16(values) => steepest(dims, values, f64::from),
                Voxels::I16(values) => steepest(dims, values, f64::from),
                Voxels::U32(values) => steepest(dims, values, f64::from),
                Voxels::I32(values) => steepest(dims, values, f64::from),
                Voxels::F32(values) => steepest(dims, values, |it| self.drawn(f64::from(it))),
                Voxels::U64(values) => steepest(dims, values, |it| it as f64),
                Voxels::I64(values) => steepest(dims, values, |it| it as f64),
                Voxels::F64(values) => steepest(dims, values, |it| self.drawn(it)),
            }
        })
    }
}

fn steepest<S: Copy + Sync>(
    [nx, ny, nz]: [usize; 3],
    values: &[S],
    number: impl Fn(S) -> f64 + Sync,
) -> [f64; 3] {
    let most = |a: &[S], b: &[S]| {
        let pairs = a.iter().zip(b);
        pairs.fold(0.0_f64, |most, (a, b)| {
            most.max((number(*a) - number(*b)).abs())
        })
    };
    (0..nz * ny)
        .into_par_iter()
        .map(|row| {
            let line = |row: usize| &values[row * nx..][..nx];
            let here = line(row);
            let y = if row % ny + 1 < ny {
                most(here, line(row + 1))
            } else {
                0.0
            };
            let z = if row / ny + 1 < nz {
                most(here, line(row + ny))
            } else {
                0.0
            };
            [most(here, &here[1..]), y, z]
        })
        .reduce(
            || [0.0; 3],
            |a, b| [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2])],
        )
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::{Grid, Volume, Voxels};

    #[test]
    fn it_is_that_of_the_steepest_pair_along_each_axis() {
        let mut values = vec![0_f32; 4 * 3 * 2];
        let mut set =
            |x: usize, y: usize, z: usize, value: f32| values[(z * 3 + y) * 4 + x] = value;
        // A ramp along x, one step along y, and a value at a row's end that is no neighbour of the next row's start.
        for z in 0..2 {
            for y in 0..3 {
                for x in 0..4 {
                    set(x, y, z, 2.0 * x as f32 + if y == 2 { 5.0 } else { 0.0 });
                }
            }
        }
        set(3, 0, 1, -1.0);
        let grid = Grid::axis_aligned([4, 3, 2], DVec3::ONE, DVec3::ZERO);
        let volume = Volume::new("v", grid, Voxels::F32(values)).unwrap();
        assert_eq!(volume.steepness(), [5.0, 7.0, 7.0]);
    }

    #[test]
    fn one_voxel_is_flat() {
        let grid = Grid::axis_aligned([1, 1, 1], DVec3::ONE, DVec3::ZERO);
        let volume = Volume::new("v", grid, Voxels::U8(vec![3])).unwrap();
        assert_eq!(volume.steepness(), [0.0; 3]);
    }
}
