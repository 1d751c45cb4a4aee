//! What the user says about a file beside its path, and the two ways to a volume in one call.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use volgraph_volume::{
    Component, DEFAULT_MAX_BYTES, Grid, ScalarType, Trouble, Volume, VolumeError,
};

use crate::reader::VolumeReader;

/// Called while voxels are read, with the bytes that are there and the bytes that will be.
pub type Progress = Arc<dyn Fn(u64, u64) + Send + Sync>;

/// What the user says about a file beside its path. All are optional.
#[derive(Clone, Default)]
pub struct LoadOptions {
    /// Dimensions of a raw file, x fastest; wins over its name. For other formats they must agree.
    pub dims: Option<[u32; 3]>,
    /// Type of a raw file; wins over its name. For other formats it must agree.
    pub scalar_type: Option<ScalarType>,
    /// The voxels of a raw file are big-endian; the headers of other formats say so themselves.
    pub big_endian: bool,
    /// Spacing instead of the file's, along its directions; a negative length turns its axis around, for files that
    /// store their slices the other way.
    pub spacing: Option<DVec3>,
    /// Centre of the first voxel instead of the file's.
    pub origin: Option<DVec3>,
    /// Moves the placed volume: from its own world to another one.
    pub transform: Option<DAffine3>,
    /// Makes the volume node-centred, whatever the file says.
    pub node_centred: bool,
    /// What to take where a file has several values per voxel; they are counted with the fastest axis first.
    pub component: Option<Component>,
    /// Which time step to take, from 0; the first where `None`.
    pub time: Option<u32>,
    /// Which volume to take where there are several: a series of a DICOM folder, an array of a Zarr group, a dataset.
    /// A part of the name is enough where only one has it.
    pub part: Option<String>,
    /// Which level of a multi-resolution file to take; 0, the finest, where `None`.
    pub level: Option<u32>,
    /// Most voxel bytes, all components together; [`DEFAULT_MAX_BYTES`] where `None`.
    pub max_bytes: Option<u64>,
    /// Called while voxels are read.
    pub progress: Option<Progress>,
}

impl fmt::Debug for LoadOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LoadOptions")
            .field("dims", &self.dims)
            .field("scalar_type", &self.scalar_type)
            .field("big_endian", &self.big_endian)
            .field("spacing", &self.spacing)
            .field("origin", &self.origin)
            .field("transform", &self.transform)
            .field("node_centred", &self.node_centred)
            .field("component", &self.component)
            .field("time", &self.time)
            .field("part", &self.part)
            .field("level", &self.level)
            .field("max_bytes", &self.max_bytes)
            .finish_non_exhaustive()
    }
}

/// What the stream readers need of the options.
pub(crate) struct Limits {
    pub max_bytes: u64,
    progress: Option<Progress>,
}

impl Limits {
    pub fn new(max_bytes: Option<u64>, progress: Option<Progress>) -> Self {
        Self {
            max_bytes: max_bytes.unwrap_or(DEFAULT_MAX_BYTES),
            progress,
        }
    }

    pub fn report(&self, done: u64, total: u64) {
        if let Some(progress) = &self.progress {
            progress(done, total);
        }
    }
}

impl LoadOptions {
    /// Refuses options that contradict what a header says.
    pub(crate) fn agree(&self, dims: [u32; 3], scalar_type: ScalarType) -> Result<(), VolumeError> {
        let conflict = |said: String, is: String| {
            Err(VolumeError::Option(Trouble::new(
                format!("the options say {said}, the header says {is}"),
                "leave the option out: a file with a header tells it itself",
            )))
        };
        match (self.dims, self.scalar_type) {
            (Some(said), _) if said != dims => conflict(format!("{said:?}"), format!("{dims:?}")),
            (_, Some(said)) if said != scalar_type => {
                conflict(said.to_string(), scalar_type.to_string())
            }
            _ => Ok(()),
        }
    }

    /// The grid with the placement that the options ask for, checked.
    pub(crate) fn place(&self, mut grid: Grid) -> Result<Grid, VolumeError> {
        if let Some(spacing) = self
            .spacing
            .filter(|s| !(s.is_finite() && s.abs().min_element() > 0.0))
        {
            return Err(VolumeError::Option(Trouble::new(
                format!("the options ask for a spacing of {spacing}"),
                "give three lengths other than 0; a negative one turns its axis around",
            )));
        }
        grid.check()?;
        grid.node_centred |= self.node_centred;
        let mut placed = grid.with_placement(self.spacing, self.origin);
        if let Some(transform) = self.transform {
            placed.world_from_index = transform * placed.world_from_index;
        }
        placed.check()?;
        Ok(placed)
    }
}

/// Reads a volume from a file, a folder or a glob (`slices/*.tif`). The content decides what it is, then the name.
///
/// # Errors
/// A [`VolumeError`] that names the file, the header line where there is one, the cause and the remedy.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Volume, VolumeError> {
    VolumeReader::open(path, options)?.read(options.time)
}

/// Reads a volume from the bytes of a whole file. `name` is the file's name: raw voxels are described by it, and
/// errors name it. A header that names other files as its data is refused.
///
/// # Errors
/// As [`load`].
pub fn from_bytes(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Volume, VolumeError> {
    VolumeReader::from_bytes(name, bytes, options)?.read(options.time)
}
