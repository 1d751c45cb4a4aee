//! The scene in a mirror across an axis of the world, through the middle of its volumes.
//!
//! Voxels are reversed along the index axis that lies nearest to the mirror's, so that not only the placement is another
//! one, but also what lies beside what in memory. What parameters place in the world (lights, clips) is not mirrored.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use volgraph_graph::Source;
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_volume::{Grid, Volume, VolumeError, Voxels};

use crate::case::Axis;
use crate::{Camera, Picture};

impl Axis {
    fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

/// World positions in the mirror from world positions.
fn mirror(axis: Axis, middle: DVec3) -> DAffine3 {
    let mut scale = DVec3::ONE;
    scale[axis.index()] = -1.0;
    DAffine3 {
        matrix3: DMat3::from_diagonal(scale),
        translation: middle - scale * middle,
    }
}

/// The camera in the mirror; what was to its right is to its left there.
pub(in crate::case) fn camera(camera: &Camera, axis: Axis, middle: DVec3) -> Camera {
    let mirror = mirror(axis, middle);
    Camera {
        eye: mirror.transform_point3(camera.eye),
        right: -mirror.transform_vector3(camera.right),
        up: mirror.transform_vector3(camera.up),
        forward: mirror.transform_vector3(camera.forward),
        projection: camera.projection,
    }
}

/// A picture in a mirror: columns reversed.
pub(in crate::case) fn picture(picture: &Picture) -> Picture {
    super::moved(picture, |x, y| [picture.width - 1 - x, y])
}

/// A volume in the mirror; any other source as it is.
pub(in crate::case) fn source(
    source: &Arc<dyn Source>,
    axis: Axis,
    middle: DVec3,
) -> Result<Arc<dyn Source>, VolumeError> {
    let Some(VolumeSource { volume, .. }) = source.as_any().downcast_ref::<VolumeSource>() else {
        return Ok(Arc::clone(source));
    };
    let grid = volume.grid();
    let along = |at: usize| grid.world_from_index.matrix3.col(at).normalize_or_zero()[axis.index()];
    let reversed = (0..3)
        .max_by(|a, b| along(*a).abs().total_cmp(&along(*b).abs()))
        .unwrap_or_default();
    let mut unreverse = DAffine3::IDENTITY;
    unreverse.matrix3.col_mut(reversed)[reversed] = -1.0;
    unreverse.translation[reversed] = f64::from(grid.dims[reversed]) - 1.0;
    let mirrored = Grid {
        world_from_index: mirror(axis, middle) * grid.world_from_index * unreverse,
        ..*grid
    };
    let voxels = reverse(volume.voxels(), grid.dims, reversed);
    let volume = Volume::new(volume.name(), mirrored, voxels)?;
    Ok(Arc::new(VolumeSource::new(Arc::new(volume))))
}

/// The voxels in reverse along an axis.
fn reverse(voxels: &Voxels, dims: [u32; 3], axis: usize) -> Voxels {
    fn of<T: Copy>(values: &[T], [nx, ny, nz]: [usize; 3], axis: usize) -> Vec<T> {
        let mut reversed = Vec::with_capacity(values.len());
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let mut at = [x, y, z];
                    at[axis] = [nx, ny, nz][axis] - 1 - at[axis];
                    reversed.push(values[(at[2] * ny + at[1]) * nx + at[0]]);
                }
            }
        }
        reversed
    }
    let dims = dims.map(|n| n as usize);
    match voxels {
        Voxels::U8(values) => of(values, dims, axis).into(),
        Voxels::I8(values) => of(values, dims, axis).into(),
        Voxels::U16(values) => of(values, dims, axis).into(),
        Voxels::I16(values) => of(values, dims, axis).into(),
        Voxels::U32(values) => of(values, dims, axis).into(),
        Voxels::I32(values) => of(values, dims, axis).into(),
        Voxels::U64(values) => of(values, dims, axis).into(),
        Voxels::I64(values) => of(values, dims, axis).into(),
        Voxels::F32(values) => of(values, dims, axis).into(),
        Voxels::F64(values) => of(values, dims, axis).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_in_the_mirror_is_the_mirrored_field() {
        // Oblique, so that no index axis is the world's.
        let turn = DMat3::from_rotation_z(0.3) * DMat3::from_diagonal(DVec3::new(1.0, 2.0, 0.5));
        let grid = Grid {
            dims: [3, 4, 2],
            world_from_index: DAffine3 {
                matrix3: turn,
                translation: DVec3::new(5.0, -1.0, 2.0),
            },
            node_centred: false,
        };
        let values: Vec<f32> = (0..24_u8).map(f32::from).collect();
        let volume = Volume::new("v", grid, values.into()).unwrap();
        let source: Arc<dyn Source> = Arc::new(VolumeSource::new(Arc::new(volume)));
        let middle = DVec3::new(1.0, 2.0, 3.0);
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            let there = super::source(&source, axis, middle).unwrap();
            let there = &there
                .as_any()
                .downcast_ref::<VolumeSource>()
                .unwrap()
                .volume;
            let here = &source
                .as_any()
                .downcast_ref::<VolumeSource>()
                .unwrap()
                .volume;
            let mirror = mirror(axis, middle);
            for (z, y, x) in
                (0..2).flat_map(|z| (0..4).flat_map(move |y| (0..3).map(move |x| (z, y, x))))
            {
                let index = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                let world = mirror.transform_point3(grid.world_from_index.transform_point3(index));
                let index = there
                    .grid()
                    .world_from_index
                    .inverse()
                    .transform_point3(world);
                let value = there.trilinear(index);
                assert!(
                    (value - here.voxel([x, y, z])).abs() < 1e-9,
                    "{axis:?} {value}"
                );
            }
        }
    }
}
