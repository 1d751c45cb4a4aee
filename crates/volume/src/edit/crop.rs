//! A box of voxels cut out of a volume.

use glam::DVec3;
use rayon::prelude::*;

use super::{Parts, Watch, like, reserve};
use crate::error::Trouble;
use crate::{Element, Grid, Volume, VolumeError, for_voxels};

/// The voxels from the index `low` on, `dims` of them along each axis; they stay where they are in the world.
///
/// # Errors
/// [`VolumeError::Option`] where the box is empty or reaches out of the volume; [`VolumeError::Interrupted`].
pub fn crop(
    volume: &Volume,
    low: [u32; 3],
    dims: [u32; 3],
    watch: &Watch,
) -> Result<Volume, VolumeError> {
    let old = volume.grid();
    for axis in 0..3 {
        let end = u64::from(low[axis]) + u64::from(dims[axis]);
        if dims[axis] == 0 || end > u64::from(old.dims[axis]) {
            return Err(VolumeError::Option(Trouble::new(
                format!(
                    "a box from {low:?} of {dims:?} voxels is not inside a volume of {:?}",
                    old.dims
                ),
                "give a first voxel and a size of at least one voxel that stay inside",
            )));
        }
    }
    let mut grid = Grid { dims, ..*old };
    let first = DVec3::new(low[0].into(), low[1].into(), low[2].into());
    grid.world_from_index.translation = old.world_from_index.transform_point3(first);
    let voxels = for_voxels!(volume.voxels(), values => {
        Element::wrap(cut(values, old.dims, low, dims, watch)?)
    });
    let made = Volume::new(volume.name(), grid, voxels)?.with_about(volume.about().clone());
    let made = match volume.colors() {
        Some(colors) => made.with_colors(cut(colors, old.dims, low, dims, watch)?)?,
        None => made,
    };
    Ok(like(made, volume))
}

fn cut<T: bytemuck::Pod + Send + Sync>(
    values: &[T],
    old: [u32; 3],
    low: [u32; 3],
    dims: [u32; 3],
    watch: &Watch,
) -> Result<Vec<T>, VolumeError> {
    let [nx, ny, _] = old.map(|n| n as usize);
    let [x, y, z] = low.map(|n| n as usize);
    let [mx, my, mz] = dims.map(|n| n as usize);
    let mut out: Vec<T> = reserve(mx * my * mz)?;
    let parts = Parts::new(watch, out.len() * size_of::<T>());
    out.par_chunks_mut(mx * my)
        .enumerate()
        .try_for_each(|(k, slice)| {
            for (j, row) in slice.chunks_exact_mut(mx).enumerate() {
                let from = ((z + k) * ny + y + j) * nx + x;
                row.copy_from_slice(&values[from..from + mx]);
            }
            parts.step(size_of_val(slice))
        })?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Voxels;
    use glam::{DAffine3, DMat3};

    fn volume() -> Volume {
        let grid = Grid {
            dims: [4, 3, 2],
            world_from_index: DAffine3 {
                matrix3: DMat3::from_cols(
                    DVec3::new(0.0, 2.0, 0.0),
                    DVec3::new(3.0, 0.0, 1.0),
                    DVec3::new(0.0, 0.5, 4.0),
                ),
                translation: DVec3::new(10.0, 20.0, 30.0),
            },
            node_centred: true,
        };
        let colors = (0..24).map(|i| [i, 1, 2, 3]).collect();
        Volume::new("v", grid, (0..24_u8).collect::<Vec<_>>().into())
            .unwrap()
            .with_colors(colors)
            .unwrap()
    }

    #[test]
    fn what_is_cut_out_stays_where_it_was() {
        let all = volume();
        let part = crop(&all, [1, 1, 1], [2, 2, 1], &Watch::default()).unwrap();
        assert_eq!(part.voxels(), &Voxels::from(vec![17_u8, 18, 21, 22]));
        assert_eq!(part.colors().unwrap()[3], [22, 1, 2, 3]);
        assert!(part.grid().node_centred);
        let at = |volume: &Volume, index| volume.grid().world_from_index.transform_point3(index);
        let (a, b) = (
            at(&part, DVec3::new(1.0, 1.0, 0.0)),
            at(&all, DVec3::new(2.0, 2.0, 1.0)),
        );
        assert_eq!(a, b);
    }

    #[test]
    fn boxes_that_are_empty_or_outside_are_refused() {
        for (low, dims) in [
            ([0, 0, 0], [4, 3, 0]),
            ([1, 0, 0], [4, 1, 1]),
            ([u32::MAX, 0, 0], [u32::MAX, 1, 1]),
        ] {
            let error = crop(&volume(), low, dims, &Watch::default()).unwrap_err();
            assert_eq!(error.code(), "volume-option");
        }
    }

    #[test]
    fn an_interrupt_stops_the_work() {
        let stop = Watch {
            interrupt: Some(std::sync::Arc::new(true.into())),
            ..Watch::default()
        };
        let error = crop(&volume(), [0; 3], [1; 3], &stop).unwrap_err();
        assert_eq!(error.code(), "volume-interrupted");
    }
}
