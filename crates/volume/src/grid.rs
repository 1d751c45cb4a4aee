//! Where the samples of a volume lie: dimensions and one affine map from index to world space.

use glam::{DAffine3, DMat3, DVec3};

use crate::VolumeError;
use crate::error::Trouble;

/// How far from singular the normalised axes must be: the determinant of their unit vectors.
const SMALLEST_DETERMINANT: f64 = 1e-9;

/// A regular grid of samples in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Samples along x (fastest in memory), y and z; each at least 1.
    pub dims: [u32; 3],
    /// World from index: index (0, 0, 0) is the centre of the first voxel, its columns are the steps from a
    /// sample to the next one along each axis. The world frame is LPS (see the crate's first page).
    pub world_from_index: DAffine3,
    /// Whether the box spans sample to sample (`0..n-1`) instead of whole voxels (`-0.5..n-0.5`).
    pub node_centred: bool,
}

impl Grid {
    /// A cell-centred grid along the world axes. `origin` is the centre of the first voxel. Unchecked: see
    /// [`Grid::check`].
    #[must_use]
    pub fn axis_aligned(dims: [u32; 3], spacing: DVec3, origin: DVec3) -> Self {
        Self {
            dims,
            world_from_index: DAffine3 {
                matrix3: DMat3::from_diagonal(spacing),
                translation: origin,
            },
            node_centred: false,
        }
    }

    /// Tests that there is a voxel and that the map can be inverted.
    ///
    /// # Errors
    /// [`VolumeError::Grid`] where a dimension is 0, or the map is not finite or singular.
    pub fn check(&self) -> Result<(), VolumeError> {
        let refuse =
            |cause: String, remedy: &str| Err(VolumeError::Grid(Trouble::new(cause, remedy)));
        let [nx, ny, nz] = self.dims;
        if self.dims.contains(&0) {
            return refuse(
                format!("a grid of {nx}×{ny}×{nz} has no voxel"),
                "give each axis at least one sample",
            );
        }
        let spacing = self.spacing();
        if !self.world_from_index.is_finite() || !spacing.is_finite() {
            return refuse(
                format!(
                    "the placement is not finite: spacing {:?}, origin {:?}",
                    spacing.to_array(),
                    self.origin().to_array()
                ),
                "give finite spacing, directions and origin",
            );
        }
        if spacing.min_element() <= 0.0 {
            return refuse(
                format!("the spacing {:?} has a zero", spacing.to_array()),
                "give each axis a spacing other than zero",
            );
        }
        let matrix = self.world_from_index.matrix3;
        let unit = DMat3::from_cols(
            matrix.x_axis / spacing.x,
            matrix.y_axis / spacing.y,
            matrix.z_axis / spacing.z,
        );
        let determinant = unit.determinant().abs();
        if determinant.is_nan() || determinant < SMALLEST_DETERMINANT {
            return refuse(
                format!(
                    "the axes {:?} lie in one plane (determinant {determinant:e})",
                    unit.to_cols_array_2d()
                ),
                "give three independent directions",
            );
        }
        Ok(())
    }

    /// Distance from a sample to the next one along each axis, in world units.
    #[must_use]
    pub fn spacing(&self) -> DVec3 {
        let matrix = &self.world_from_index.matrix3;
        DVec3::new(
            matrix.x_axis.length(),
            matrix.y_axis.length(),
            matrix.z_axis.length(),
        )
    }

    /// The smallest of the three spacings.
    #[must_use]
    pub fn min_spacing(&self) -> f64 {
        self.spacing().min_element()
    }

    /// World position of the centre of the first voxel.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.world_from_index.translation
    }

    /// Number of voxels.
    #[must_use]
    pub fn voxel_count(&self) -> u64 {
        // Three u32 can pass u64; such a grid never holds voxels, and saturating keeps it refused.
        self.dims
            .iter()
            .fold(1_u64, |product, &n| product.saturating_mul(n.into()))
    }

    /// The box of the volume in index space, lowest and highest corner: `-0.5..n-0.5`, or `0..n-1` where
    /// `node_centred`. A node-centred axis with a single sample spans its one cell, `-0.5..0.5`: a box without
    /// extent could not be seen.
    #[must_use]
    pub fn box_index(&self) -> (DVec3, DVec3) {
        let half = self
            .dims
            .map(|n| if self.node_centred && n > 1 { 0.0 } else { 0.5 });
        let last = self.dims.map(|n| f64::from(n) - 1.0);
        let (half, last) = (DVec3::from_array(half), DVec3::from_array(last));
        (-half, last + half)
    }

    /// The eight corners of the box in world space; bit 0 of the position in the array is x, bit 1 y, bit 2 z.
    #[must_use]
    pub fn corners_world(&self) -> [DVec3; 8] {
        let (lo, hi) = self.box_index();
        std::array::from_fn(|corner| {
            let high = glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
            self.world_from_index
                .transform_point3(DVec3::select(high, hi, lo))
        })
    }

    /// With other spacings (the directions stay) or another origin (the centre of the first voxel).
    #[must_use]
    pub fn with_placement(mut self, spacing: Option<DVec3>, origin: Option<DVec3>) -> Self {
        if let Some(spacing) = spacing {
            let factor = spacing / self.spacing();
            let matrix = &mut self.world_from_index.matrix3;
            matrix.x_axis *= factor.x;
            matrix.y_axis *= factor.y;
            matrix.z_axis *= factor.z;
        }
        if let Some(origin) = origin {
            self.world_from_index.translation = origin;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::axis_aligned(
            [4, 3, 1],
            DVec3::new(2.0, 3.0, 4.0),
            DVec3::new(10.0, 20.0, 30.0),
        )
    }

    #[test]
    fn boxes_span_whole_voxels_or_centre_to_centre() {
        let mut grid = grid();
        assert_eq!(
            grid.box_index(),
            (DVec3::splat(-0.5), DVec3::new(3.5, 2.5, 0.5))
        );
        assert_eq!(grid.corners_world()[0], DVec3::new(9.0, 18.5, 28.0));
        assert_eq!(grid.corners_world()[7], DVec3::new(17.0, 27.5, 32.0));
        assert_eq!(grid.corners_world()[1], DVec3::new(17.0, 18.5, 28.0));
        grid.node_centred = true;
        assert_eq!(
            grid.box_index(),
            (DVec3::new(0.0, 0.0, -0.5), DVec3::new(3.0, 2.0, 0.5))
        );
        assert_eq!((grid.voxel_count(), grid.min_spacing()), (12, 2.0));
    }

    #[test]
    fn a_placement_replaces_lengths_and_keeps_directions() {
        let mut turned = grid();
        turned.world_from_index.matrix3 =
            DMat3::from_cols(DVec3::Y * 2.0, DVec3::NEG_X * 3.0, DVec3::Z);
        let placed = turned.with_placement(Some(DVec3::new(1.0, 6.0, 5.0)), Some(DVec3::ZERO));
        assert_eq!(placed.world_from_index.matrix3.y_axis, DVec3::NEG_X * 6.0);
        assert_eq!(placed.spacing(), DVec3::new(1.0, 6.0, 5.0));
        assert_eq!(placed.origin(), DVec3::ZERO);
    }

    #[test]
    fn grids_without_voxels_or_with_a_broken_map_are_refused() {
        assert!(grid().check().is_ok());
        for spacing in [f64::NAN, f64::INFINITY, 0.0, 1e300, 1e-300] {
            let broken = grid().with_placement(Some(DVec3::new(1.0, spacing, 1.0)), None);
            assert_eq!(
                broken.check().unwrap_err().code(),
                "volume-grid",
                "{spacing}"
            );
        }
        let mut flat = grid();
        flat.world_from_index.matrix3.z_axis = DVec3::new(1.0, 1.0, 0.0);
        assert_eq!(flat.check().unwrap_err().code(), "volume-grid");
        let mut empty = grid();
        empty.dims[1] = 0;
        assert_eq!(empty.check().unwrap_err().code(), "volume-grid");
    }
}
