//! From the axes of a file to the three of a grid.
//!
//! A file may have fewer than three spatial axes (they are padded with one voxel each) and axes that are not
//! spatial (vector components, colours, times), of which one combination is picked by the `component` option.

use glam::{DMat3, DVec3};

use crate::error::Trouble;
use crate::load::LoadOptions;
use crate::voxels::for_voxels;
use crate::{Element, VolumeError, Voxels};

/// Sizes of all axes, fastest first, and which of them are spatial.
#[derive(Debug)]
pub(crate) struct Axes {
    sizes: Vec<u64>,
    spatial: Vec<usize>,
}

impl Axes {
    /// # Errors
    /// A size of 0, a spatial size over 32 bits, or more than three spatial axes.
    pub fn new(sizes: Vec<u64>, spatial: Vec<usize>) -> Result<Self, VolumeError> {
        if let Some(axis) = sizes.iter().position(|&size| size == 0) {
            return Err(VolumeError::Grid(Trouble::new(
                format!("axis {} of {} has no samples", axis + 1, sizes.len()),
                "give each axis at least one sample",
            )));
        }
        if spatial.is_empty() || spatial.len() > 3 {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("{} spatial axes; a volume has one to three", spatial.len()),
                "cut the file to three axes, or say which ones are not spatial (NRRD: `kinds`, or `none` in \
                 `space directions`)",
            )));
        }
        if let Some(&axis) = spatial
            .iter()
            .find(|&&axis| u32::try_from(sizes[axis]).is_err())
        {
            return Err(VolumeError::TooLarge(Trouble::new(
                format!("axis {} has {} samples", axis + 1, sizes[axis]),
                "give each axis less than 2^32 samples",
            )));
        }
        Ok(Self { sizes, spatial })
    }

    /// Number of elements over all axes.
    pub fn count(&self) -> Result<u64, VolumeError> {
        self.sizes
            .iter()
            .try_fold(1_u64, |product, &size| product.checked_mul(size))
            .ok_or_else(|| {
                VolumeError::TooLarge(Trouble::new(
                    format!("sizes of {:?} are more than 2^64 voxels", self.sizes),
                    "correct the dimensions",
                ))
            })
    }

    pub fn dims(&self) -> [u32; 3] {
        let mut dims = [1; 3];
        for (dim, &axis) in dims.iter_mut().zip(&self.spatial) {
            // `new` has seen that it fits.
            *dim = u32::try_from(self.sizes[axis]).unwrap_or(u32::MAX);
        }
        dims
    }

    /// `3×4×5 int16`, for messages.
    pub fn describe(&self, scalar_type: crate::ScalarType) -> String {
        let sizes: Vec<String> = self.sizes.iter().map(u64::to_string).collect();
        format!("{} {scalar_type}", sizes.join("×"))
    }

    /// The component that the options name, or the only one.
    pub fn component(&self, options: &LoadOptions) -> Result<u64, VolumeError> {
        let others = (0..self.sizes.len()).filter(|axis| !self.spatial.contains(axis));
        let count = others.fold(1_u64, |n, axis| n.saturating_mul(self.sizes[axis]));
        match options.component.map(u64::from) {
            None if count == 1 => Ok(0),
            Some(component) if component < count => Ok(component),
            None => Err(VolumeError::Component(Trouble::new(
                format!("there are {count} values per voxel, and a volume takes one"),
                format!("name one with the option `component`, 0 to {}", count - 1),
            ))),
            Some(component) => Err(VolumeError::Component(Trouble::new(
                format!("there is no component {component}: there are {count} values per voxel"),
                format!("name one of 0 to {}", count - 1),
            ))),
        }
    }

    /// The voxels of one component, x fastest.
    pub fn select(&self, voxels: Voxels, component: u64) -> Voxels {
        let others = (0..self.sizes.len()).filter(|axis| !self.spatial.contains(axis));
        let (mut rest, mut base) = (component, 0);
        let mut components = 1;
        for axis in others {
            base += (rest % self.sizes[axis]) * self.stride(axis);
            rest /= self.sizes[axis];
            components *= self.sizes[axis];
        }
        if components == 1 {
            return voxels;
        }
        let mut strides = [0; 3];
        for (stride, &axis) in strides.iter_mut().zip(&self.spatial) {
            *stride = self.stride(axis) as usize;
        }
        for_voxels!(&voxels, values => gather(values, base as usize, self.dims(), strides))
    }

    /// Elements from one sample to the next along an axis; the total fits, and so do the strides.
    fn stride(&self, axis: usize) -> u64 {
        self.sizes[..axis].iter().product()
    }
}

fn gather<T: Element>(values: &[T], base: usize, dims: [u32; 3], strides: [usize; 3]) -> Voxels {
    let [nx, ny, nz] = dims.map(|n| n as usize);
    let mut out = Vec::with_capacity(nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            let row = base + y * strides[1] + z * strides[2];
            out.extend((0..nx).map(|x| values[row + x * strides[0]]));
        }
    }
    T::wrap(out)
}

/// Three columns from one to three: a padded axis is perpendicular to the others, as long as the shortest of
/// them (one cubic voxel thick), and completes a right-handed frame.
pub(crate) fn complete_basis(columns: &[DVec3]) -> DMat3 {
    let shortest = columns
        .iter()
        .map(|column| column.length())
        .fold(f64::INFINITY, f64::min);
    match *columns {
        [x, y, z, ..] => DMat3::from_cols(x, y, z),
        [x, y] => DMat3::from_cols(x, y, x.cross(y).normalize() * shortest),
        [x] => {
            // The first world axis behind x's own that is far enough from it; y for an axis along x.
            let along = [DVec3::Y, DVec3::Z, DVec3::X];
            let unit = x.normalize();
            let guess = along.into_iter().find(|axis| axis.dot(unit).abs() < 0.8);
            let guess = guess.unwrap_or(DVec3::Y);
            let y = (guess - unit * guess.dot(unit)).normalize();
            DMat3::from_cols(x, y * shortest, unit.cross(y) * shortest)
        }
        [] => DMat3::IDENTITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_component_is_taken_wherever_its_axis_stands() {
        let values: Vec<u8> = (0..24).collect();
        let pick = |sizes: [u64; 3], spatial: [usize; 2], component: u64| {
            let axes = Axes::new(sizes.to_vec(), spatial.to_vec()).unwrap();
            let voxels = axes.select(values.clone().into(), component);
            (axes.dims(), voxels)
        };
        let all =
            |step: u8, from: u8, n: u8| -> Vec<u8> { (0..n).map(|i| from + i * step).collect() };
        assert_eq!(pick([3, 4, 2], [1, 2], 1), ([4, 2, 1], all(3, 1, 8).into()));
        assert_eq!(
            pick([3, 4, 2], [0, 1], 1),
            ([3, 4, 1], all(1, 12, 12).into())
        );
        assert_eq!(
            pick([3, 4, 2], [0, 2], 2),
            ([3, 2, 1], vec![6_u8, 7, 8, 18, 19, 20].into())
        );
        let two = Axes::new(vec![2, 5, 3], vec![1]).unwrap();
        assert_eq!(
            two.select((0..30_u8).collect::<Vec<_>>().into(), 3),
            vec![11_u8, 13, 15, 17, 19].into()
        );
    }

    #[test]
    fn a_choice_is_asked_for_and_must_exist() {
        let axes = Axes::new(vec![3, 4, 2], vec![1, 2]).unwrap();
        let with = |component| LoadOptions {
            component,
            ..LoadOptions::default()
        };
        assert_eq!(
            axes.component(&with(None)).unwrap_err().code(),
            "volume-component"
        );
        assert_eq!(
            axes.component(&with(Some(3))).unwrap_err().code(),
            "volume-component"
        );
        assert_eq!(axes.component(&with(Some(2))).unwrap(), 2);
    }

    #[test]
    fn impossible_sizes_are_refused_before_anything_is_multiplied() {
        let code = |sizes: &[u64], spatial: &[usize]| {
            Axes::new(sizes.to_vec(), spatial.to_vec())
                .and_then(|axes| axes.count())
                .unwrap_err()
                .code()
        };
        assert_eq!(code(&[1, 0, 1], &[0, 1, 2]), "volume-grid");
        assert_eq!(code(&[1; 4], &[0, 1, 2, 3]), "volume-unsupported");
        assert_eq!(code(&[1 << 32, 1, 1], &[0, 1, 2]), "volume-too-large");
        assert_eq!(code(&[u64::MAX, 2, 2], &[1, 2]), "volume-too-large");
    }

    #[test]
    fn padded_axes_complete_a_right_handed_frame() {
        let x = DVec3::new(2.0, 0.0, 0.0);
        assert_eq!(
            complete_basis(&[x]),
            DMat3::from_diagonal(DVec3::splat(2.0))
        );
        let y = DVec3::new(0.0, 0.0, 5.0);
        assert_eq!(complete_basis(&[x, y]).z_axis, DVec3::new(0.0, -2.0, 0.0));
        for axis in [DVec3::Y, DVec3::NEG_Z, DVec3::ONE] {
            assert!((complete_basis(&[axis]).determinant() - axis.length().powi(3)).abs() < 1e-12);
        }
    }
}
