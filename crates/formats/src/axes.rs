//! From the axes of a file to the three of a grid.
//!
//! A file may have fewer than three spatial axes (they are padded with one voxel each), a time axis, of which one step
//! is read at a time, and axes that hold several values per voxel (vectors, colours), which are counted with the
//! fastest first.

use glam::{DMat3, DVec3};

use volgraph_volume::{Element, ScalarType, Trouble, VolumeError, Voxels, for_voxels};

/// Sizes of all axes, fastest first, and which of them are space and time; the others are components.
#[derive(Clone, Debug)]
pub(crate) struct Axes {
    sizes: Vec<u64>,
    spatial: Vec<usize>,
    time: Option<usize>,
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
        Ok(Self {
            sizes,
            spatial,
            time: None,
        })
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
    pub fn describe(&self, scalar_type: ScalarType) -> String {
        let sizes: Vec<String> = self.sizes.iter().map(u64::to_string).collect();
        format!("{} {scalar_type}", sizes.join("×"))
    }

    /// With an axis of time steps, which must be none of the spatial ones.
    ///
    /// # Errors
    /// More than 2^32 steps.
    pub fn with_time(mut self, axis: usize) -> Result<Self, VolumeError> {
        debug_assert!(!self.spatial.contains(&axis));
        if u32::try_from(self.sizes[axis]).is_err() {
            return Err(VolumeError::TooLarge(Trouble::new(
                format!("{} time steps", self.sizes[axis]),
                "give less than 2^32 of them",
            )));
        }
        self.time = Some(axis);
        Ok(self)
    }

    /// With time steps behind all other axes, for files that are a step each.
    ///
    /// # Errors
    /// More than 2^32 steps.
    pub fn with_steps_behind(mut self, steps: u64) -> Result<Self, VolumeError> {
        self.sizes.push(steps);
        let axis = self.sizes.len() - 1;
        self.with_time(axis)
    }

    /// Number of time steps; 1 where there is no time.
    pub fn steps(&self) -> u32 {
        let steps = self.time.map_or(1, |axis| self.sizes[axis]);
        // `with_time` has seen that it fits.
        u32::try_from(steps).unwrap_or(u32::MAX)
    }

    /// Values per voxel and time step.
    pub fn component_count(&self) -> u64 {
        let components = self.component_axes().map(|axis| self.sizes[axis]);
        components.fold(1, u64::saturating_mul)
    }

    /// Voxels of one component and step; they were counted before they were read, so they fit.
    pub fn voxel_count(&self) -> usize {
        self.dims().iter().map(|&n| n as usize).product()
    }

    fn component_axes(&self) -> impl Iterator<Item = usize> {
        (0..self.sizes.len())
            .filter(|axis| !self.spatial.contains(axis) && self.time != Some(*axis))
    }

    /// Where the elements of a step lie in the file: from which one on, and how many. `None` where its elements do not
    /// lie together, for then all must be read and [`Axes::step`] takes them out.
    pub fn run_of_step(&self, step: u32) -> Option<(u64, u64)> {
        let Some(time) = self.time else {
            return Some((0, self.sizes.iter().product()));
        };
        let slower: u64 = self.sizes[time + 1..].iter().product();
        let each = self.stride(time);
        (slower == 1).then(|| (u64::from(step) * each, each))
    }

    /// The elements of one step out of those of all.
    pub fn step(&self, voxels: Voxels, step: u32) -> Voxels {
        let Some(time) = self.time else { return voxels };
        let each = self.stride(time) as usize;
        let (from, all) = (step as usize * each, each * self.sizes[time] as usize);
        for_voxels!(&voxels, values => {
            let blocks = values.chunks_exact(all).flat_map(|block| &block[from..from + each]);
            Element::wrap(blocks.copied().collect())
        })
    }

    /// Whether a step is one value per voxel, x fastest, then y, then z.
    pub fn is_plain(&self) -> bool {
        self.component_count() == 1 && self.spatial.windows(2).all(|pair| pair[0] < pair[1])
    }

    /// The voxels of one component out of those of one step, x fastest.
    pub fn select(&self, voxels: Voxels, component: u64) -> Voxels {
        let in_order = self.spatial.windows(2).all(|pair| pair[0] < pair[1]);
        if self.component_count() == 1 && in_order {
            return voxels;
        }
        self.selected(&voxels, component)
    }

    /// As [`Axes::select`], where the voxels are needed again.
    pub fn selected(&self, voxels: &Voxels, component: u64) -> Voxels {
        let (mut rest, mut base) = (component, 0);
        for axis in self.component_axes() {
            base += (rest % self.sizes[axis]) * self.stride_in_step(axis);
            rest /= self.sizes[axis];
        }
        let mut strides = [0; 3];
        for (stride, &axis) in strides.iter_mut().zip(&self.spatial) {
            *stride = self.stride_in_step(axis) as usize;
        }
        for_voxels!(voxels, values => gather(values, base as usize, self.dims(), strides))
    }

    /// Elements from one sample to the next along an axis, where only one time step is there.
    fn stride_in_step(&self, axis: usize) -> u64 {
        let faster = (0..axis).filter(|faster| self.time != Some(*faster));
        faster.map(|faster| self.sizes[faster]).product()
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
    fn a_step_is_taken_wherever_time_stands() {
        let values: Vec<u8> = (0..24).collect();
        // Components fastest, then time, then space.
        let axes = Axes::new(vec![2, 3, 4], vec![2])
            .unwrap()
            .with_time(1)
            .unwrap();
        assert_eq!(
            (axes.steps(), axes.component_count(), axes.run_of_step(1)),
            (3, 2, None)
        );
        let step = axes.step(values.clone().into(), 1);
        assert_eq!(step, vec![2_u8, 3, 8, 9, 14, 15, 20, 21].into());
        assert_eq!(axes.select(step, 1), vec![3_u8, 9, 15, 21].into());
        let last = Axes::new(vec![2, 4, 3], vec![1])
            .unwrap()
            .with_time(2)
            .unwrap();
        assert_eq!(last.run_of_step(2), Some((16, 8)));
        let first = Axes::new(vec![3, 4, 2], vec![1, 2])
            .unwrap()
            .with_time(0)
            .unwrap();
        let step = first.step(values.into(), 2);
        assert_eq!(first.select(step.clone(), 0), step);
        assert_eq!(step, vec![2_u8, 5, 8, 11, 14, 17, 20, 23].into());
    }

    #[test]
    fn spatial_axes_may_stand_in_any_order() {
        let axes = Axes::new(vec![2, 3], vec![1, 0]).unwrap();
        assert_eq!(axes.dims(), [3, 2, 1]);
        assert_eq!(
            axes.select(vec![0_u8, 1, 2, 3, 4, 5].into(), 0),
            vec![0_u8, 2, 4, 1, 3, 5].into()
        );
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
