//! What a file says before a voxel is read: the one shape that all formats are brought to.

use std::path::PathBuf;

use volgraph_volume::{About, Grid, ScalarType, VolumeError, Voxels};

use crate::axes::Axes;
use crate::load::Limits;
use crate::stream::FileRun;

/// A file whose header was read and checked, and the way to its voxels.
pub(crate) struct Opened<'a> {
    pub contents: Contents,
    pub data: Box<dyn Data + 'a>,
}

/// The way to the voxels of an opened file.
pub(crate) trait Data: Send + Sync {
    /// All values of one time step (0 where there is one), in the order of [`Contents::axes`] without the time axis,
    /// of the type [`Contents::scalar_type`]. Must not allocate much more than the file holds or `limits` allow.
    fn read(&self, step: u32, limits: &Limits) -> Result<Voxels, VolumeError>;

    /// Where the voxels of a step lie, if they are plain ones in one run of one file; its length was checked.
    fn run(&self, _step: u32, _limits: &Limits) -> Result<Option<FileRun>, VolumeError> {
        Ok(None)
    }
}

/// What a file says.
#[derive(Debug)]
pub(crate) struct Contents {
    /// A short name: the file's without its endings, unless the format knows a better one.
    pub name: String,
    /// Sizes of all axes, and which of them are space, time and components.
    pub axes: Axes,
    /// The type of the values as [`Data::read`] gives them.
    pub scalar_type: ScalarType,
    /// Placement in LPS; its dimensions are those of the axes.
    pub grid: Grid,
    /// Units and meaning; `picked` and `step` are filled in by the reader of the volume.
    pub about: About,
    /// What the components are, which decides what is taken where the user does not say.
    pub components: Components,
    /// Time of each step, where the file tells it; empty or as many as there are steps.
    pub times: Vec<f64>,
    /// Unit of the times.
    pub time_unit: Option<String>,
    /// Other files that hold voxels or parts of the header.
    pub data_files: Vec<PathBuf>,
    /// What the user should know, without the file's name.
    pub warnings: Vec<String>,
    /// Header line of the sizes, 0 where there is none.
    pub sizes_line: u32,
}

/// What several values per voxel are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Components {
    /// Vectors, or nobody knows: the user has to choose.
    #[default]
    Values,
    /// Two to four channels of gray, red, green, blue and alpha: drawn as they are unless the user chooses.
    Colors,
}

impl Contents {
    /// Contents of one component and one step with no more said than name, axes, type and placement.
    pub fn new(
        format: impl Into<String>,
        name: String,
        axes: Axes,
        scalar_type: ScalarType,
        grid: Grid,
    ) -> Self {
        Self {
            name,
            axes,
            scalar_type,
            grid,
            about: About {
                format: format.into(),
                ..About::default()
            },
            components: Components::default(),
            times: Vec::new(),
            time_unit: None,
            data_files: Vec::new(),
            warnings: Vec::new(),
            sizes_line: 0,
        }
    }
}
