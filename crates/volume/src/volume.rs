//! A volume: voxels on a grid, with a name, a digest and statistics.

use std::fmt;
use std::path::PathBuf;
use std::sync::OnceLock;

use glam::{DAffine3, DVec3, UVec3};

use crate::error::Trouble;
use crate::for_voxels;
use crate::{About, Grid, Histogram, Statistics, VolumeError, Voxels};

/// The limit on voxel bytes of one volume where nobody names another: 16 GiB.
pub const DEFAULT_MAX_BYTES: u64 = 16 << 30;

/// A BLAKE3 digest of grid, type and voxels; displays as 64 hexadecimal digits.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Digest([u8; 32]);

impl Digest {
    /// The 32 bytes.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// 64 hexadecimal digits.
    #[must_use]
    pub fn to_hex(&self) -> String {
        self.to_string()
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Digest({self})")
    }
}

/// A scalar field sampled on a grid. It does not change once made; share it in an `Arc`.
pub struct Volume {
    name: String,
    grid: Grid,
    voxels: Voxels,
    about: About,
    colors: Option<Vec<[u8; 4]>>,
    source_files: Vec<PathBuf>,
    warnings: Vec<String>,
    digest: OnceLock<Digest>,
    statistics: OnceLock<Statistics>,
    pub(crate) steepness: OnceLock<[f64; 3]>,
}

/// What is drawn for a voxel's value, with the range of all finite ones: itself where it is finite; the smallest for one that
/// is not a number, the nearest for an infinite one; 0 where no voxel is finite.
#[must_use]
pub fn drawn(value: f64, range: Option<(f64, f64)>) -> f64 {
    if value.is_finite() {
        return value;
    }
    let (min, max) = range.unwrap_or((0.0, 0.0));
    if value == f64::INFINITY { max } else { min }
}

impl Volume {
    /// A volume of voxels in memory, x fastest.
    ///
    /// # Errors
    /// [`VolumeError::Grid`] where the grid is not valid ([`Grid::check`]); [`VolumeError::DataTooShort`] or
    /// [`VolumeError::DataTooLong`] where the voxels do not fill the grid exactly.
    pub fn new(name: impl Into<String>, grid: Grid, voxels: Voxels) -> Result<Self, VolumeError> {
        grid.check()?;
        let (have, want) = (voxels.len() as u64, grid.voxel_count());
        let [nx, ny, nz] = grid.dims;
        let trouble = Trouble::new(
            format!("a grid of {nx}×{ny}×{nz} needs {want} voxels and got {have}"),
            "give as many voxels as the grid has",
        );
        match have.cmp(&want) {
            std::cmp::Ordering::Less => Err(VolumeError::DataTooShort(trouble)),
            std::cmp::Ordering::Greater => Err(VolumeError::DataTooLong(trouble)),
            std::cmp::Ordering::Equal => Ok(Self {
                name: name.into(),
                grid,
                voxels,
                about: About::default(),
                colors: None,
                source_files: Vec::new(),
                warnings: Vec::new(),
                digest: OnceLock::new(),
                statistics: OnceLock::new(),
                steepness: OnceLock::new(),
            }),
        }
    }

    /// With the files it was read from (header first) and what the reader wants the user to know.
    #[must_use]
    pub fn with_sources(mut self, files: Vec<PathBuf>, warnings: Vec<String>) -> Self {
        self.source_files = files;
        self.warnings = warnings;
        self
    }

    /// With what its file says of it.
    #[must_use]
    pub fn with_about(mut self, about: About) -> Self {
        self.about = about;
        self
    }

    /// With a colour per voxel: sRGB-encoded red, green and blue, and alpha, not premultiplied.
    ///
    /// # Errors
    /// [`VolumeError::DataTooShort`] or [`VolumeError::DataTooLong`] where they are not as many as the voxels.
    pub fn with_colors(mut self, colors: Vec<[u8; 4]>) -> Result<Self, VolumeError> {
        let (have, want) = (colors.len(), self.voxels.len());
        let trouble = Trouble::new(
            format!("{want} voxels need as many colours and got {have}"),
            "give one colour per voxel",
        );
        match have.cmp(&want) {
            std::cmp::Ordering::Less => Err(VolumeError::DataTooShort(trouble)),
            std::cmp::Ordering::Greater => Err(VolumeError::DataTooLong(trouble)),
            std::cmp::Ordering::Equal => {
                self.colors = Some(colors);
                self.digest = OnceLock::new();
                Ok(self)
            }
        }
    }

    /// The same voxels at another place: `transform` leads from the world that it was in to the new one.
    ///
    /// # Errors
    /// [`VolumeError::Grid`] where the transform is singular or not finite.
    pub fn moved(mut self, transform: DAffine3) -> Result<Self, VolumeError> {
        self.grid.world_from_index = transform * self.grid.world_from_index;
        self.grid.check()?;
        (self.digest, self.steepness) = Default::default();
        Ok(self)
    }

    /// What its file says of it beside grid and voxels.
    #[must_use]
    pub fn about(&self) -> &About {
        &self.about
    }

    /// A colour per voxel where the file holds colours: sRGB-encoded red, green and blue, and alpha, not
    /// premultiplied, in the order of the voxels.
    #[must_use]
    pub fn colors(&self) -> Option<&[[u8; 4]]> {
        self.colors.as_deref()
    }

    /// Where the samples lie.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The samples.
    #[must_use]
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// A short name: the file's without its endings, or the field's.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The files it was read from, header first; a change of any of them changes the volume. Empty for a
    /// volume that was computed.
    #[must_use]
    pub fn source_files(&self) -> &[PathBuf] {
        &self.source_files
    }

    /// What the reader wants the user to know, each naming its file.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Digest of the grid, the type and the voxels (not of the name), the same on every machine; computed when
    /// first asked for.
    #[must_use]
    pub fn digest(&self) -> Digest {
        *self.digest.get_or_init(|| {
            let mut hasher = blake3::Hasher::new();
            hasher.update(b"volgraph volume 1\0");
            for n in self.grid.dims {
                hasher.update(&n.to_le_bytes());
            }
            for value in self.grid.world_from_index.to_cols_array() {
                // Adding 0 makes one zero of the two.
                hasher.update(&(value + 0.0).to_le_bytes());
            }
            hasher.update(&[u8::from(self.grid.node_centred)]);
            hasher.update(self.voxels.scalar_type().name().as_bytes());
            hasher.update(b"\0");
            if cfg!(target_endian = "little") {
                hasher.update_rayon(self.voxels.as_bytes());
            } else {
                for_voxels!(&self.voxels, values => for value in values {
                    hasher.update(&value.to_le_bytes());
                });
            }
            if let Some(colors) = &self.colors {
                hasher.update(b"colors\0");
                hasher.update_rayon(colors.as_flattened());
            }
            Digest(*hasher.finalize().as_bytes())
        })
    }

    /// Statistics over all voxels; computed when first asked for.
    #[must_use]
    pub fn statistics(&self) -> &Statistics {
        self.statistics.get_or_init(|| Statistics::of(&self.voxels))
    }

    /// Histogram of the finite voxels over their whole range with as many bins as asked for (at least 1).
    #[must_use]
    pub fn histogram(&self, bins: usize) -> Histogram {
        match self.statistics().range() {
            Some((lo, hi)) => Histogram::of(&self.voxels, lo, hi, bins),
            None => Histogram::empty(bins),
        }
    }

    /// The voxel at an index, as float64; an index past the end of an axis is taken as its last.
    #[must_use]
    pub fn voxel(&self, index: [u32; 3]) -> f64 {
        let [nx, ny, _] = self.grid.dims.map(|n| n as usize);
        let last = UVec3::from_array(self.grid.dims) - 1;
        let [x, y, z] = UVec3::from_array(index)
            .min(last)
            .to_array()
            .map(|i| i as usize);
        self.voxels.get((z * ny + y) * nx + x)
    }

    /// What is drawn for a voxel's value: itself where it is finite; the smallest finite value for one that is not
    /// a number, the nearest finite one for an infinite one; 0 where no voxel is finite.
    #[must_use]
    pub fn drawn(&self, value: f64) -> f64 {
        // Statistics take a pass over all voxels.
        if value.is_finite() {
            return value;
        }
        drawn(value, self.statistics().range())
    }

    /// The field at a point of index space, trilinear in float64 over what is [drawn](Self::drawn); outside the voxel
    /// centres it is clamped (so the outer half voxel is constant across the face). A coordinate that is not a
    /// number gives not-a-number.
    #[must_use]
    pub fn trilinear(&self, index: DVec3) -> f64 {
        let last = UVec3::from_array(self.grid.dims) - 1;
        // Clamping would make a number of it.
        if index.is_nan() {
            return f64::NAN;
        }
        let point = index.clamp(DVec3::ZERO, last.as_dvec3());
        let low = point.floor().as_uvec3().min(last);
        let high = (low + 1).min(last);
        let t = point - low.as_dvec3();
        let mut sum = 0.0;
        for corner in 0..8_u32 {
            let pick = |bit: u32, low: u32, high: u32, t: f64| {
                if corner & bit == 0 {
                    (low, 1.0 - t)
                } else {
                    (high, t)
                }
            };
            let (x, wx) = pick(1, low.x, high.x, t.x);
            let (y, wy) = pick(2, low.y, high.y, t.y);
            let (z, wz) = pick(4, low.z, high.z, t.z);
            let weight = wx * wy * wz;
            sum += weight * self.drawn(self.voxel([x, y, z]));
        }
        sum
    }
}

impl fmt::Debug for Volume {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Volume")
            .field("name", &self.name)
            .field("grid", &self.grid)
            .field("type", &self.voxels.scalar_type())
            .field("source_files", &self.source_files)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(dims: [u32; 3], voxels: Vec<f64>) -> Volume {
        Volume::new(
            "v",
            Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO),
            voxels.into(),
        )
        .unwrap()
    }

    #[test]
    fn trilinear_is_exact_on_a_trilinear_function_and_clamps_outside() {
        let f =
            |p: DVec3| 1.0 + 2.0 * p.x - 3.0 * p.y + 0.5 * p.z + p.x * p.y - 2.0 * p.x * p.y * p.z;
        let mut voxels = Vec::new();
        for z in 0..4 {
            for y in 0..3 {
                for x in 0..5 {
                    voxels.push(f(DVec3::new(x.into(), y.into(), z.into())));
                }
            }
        }
        let volume = volume([5, 3, 4], voxels);
        for p in [
            DVec3::ZERO,
            DVec3::new(0.25, 1.75, 2.5),
            DVec3::new(3.999, 0.001, 1.0),
            DVec3::new(4.0, 2.0, 3.0),
        ] {
            assert!((volume.trilinear(p) - f(p)).abs() < 1e-12, "{p}");
        }
        assert_eq!(
            volume.trilinear(DVec3::new(-0.5, 1.0, 3.4)),
            f(DVec3::new(0.0, 1.0, 3.0))
        );
        assert_eq!(
            volume.trilinear(DVec3::new(1e300, f64::INFINITY, -1e300)),
            f(DVec3::new(4.0, 2.0, 0.0))
        );
        assert!(volume.trilinear(DVec3::new(f64::NAN, 0.0, 0.0)).is_nan());
    }

    #[test]
    fn one_voxel_is_a_volume_and_what_is_not_finite_is_drawn_as_the_nearest() {
        assert_eq!(
            volume([1, 1, 1], vec![7.0]).trilinear(DVec3::splat(0.3)),
            7.0
        );
        assert_eq!(
            volume([3, 1, 1], vec![1.0, 2.0, 4.0]).trilinear(DVec3::new(1.5, 0.2, 0.0)),
            3.0
        );
        let holes = volume([3, 1, 1], vec![f64::NAN, 8.0, -4.0]);
        assert_eq!(holes.trilinear(DVec3::new(0.25, 0.0, 0.0)), -1.0);
        let hot = volume([3, 1, 1], vec![f64::INFINITY, 8.0, f64::NEG_INFINITY]);
        assert_eq!(hot.trilinear(DVec3::new(0.5, 0.0, 0.0)), 8.0);
        assert_eq!(hot.voxel([9, 9, 9]), f64::NEG_INFINITY);
        let nothing = volume([2, 1, 1], vec![f64::NAN, f64::NAN]);
        assert_eq!(nothing.trilinear(DVec3::splat(0.5)), 0.0);
    }

    #[test]
    fn the_digest_sees_every_part_but_the_name() {
        let base = volume([2, 1, 1], vec![1.0, 2.0]);
        let digest = base.digest();
        assert_eq!(digest.to_hex().len(), 64);
        let renamed = Volume::new("w", *base.grid(), base.voxels().clone()).unwrap();
        assert_eq!(renamed.digest(), digest);
        let mut moved = *base.grid();
        moved.world_from_index.translation.x = 1e-9;
        let mut nodes = *base.grid();
        nodes.node_centred = true;
        let turned = Grid {
            dims: [1, 2, 1],
            ..*base.grid()
        };
        for (grid, voxels) in [
            (moved, base.voxels().clone()),
            (nodes, base.voxels().clone()),
            (turned, base.voxels().clone()),
            (*base.grid(), vec![1.0, 2.5].into()),
            (*base.grid(), vec![1.0_f32, 2.0].into()),
        ] {
            assert_ne!(Volume::new("v", grid, voxels).unwrap().digest(), digest);
        }
    }

    #[test]
    fn voxels_must_fill_the_grid() {
        let grid = Grid::axis_aligned([2, 2, 2], DVec3::ONE, DVec3::ZERO);
        let code = |n: usize| {
            Volume::new("v", grid, vec![0_u8; n].into())
                .unwrap_err()
                .code()
        };
        assert_eq!(code(7), "volume-data-too-short");
        assert_eq!(code(9), "volume-data-too-long");
    }
}
