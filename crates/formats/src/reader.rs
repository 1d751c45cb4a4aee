//! An opened file, folder or glob, of which single time steps are read.

use std::path::{Path, PathBuf};

use volgraph_volume::{About, Grid, Picked, ScalarType, Step, Trouble, Volume, VolumeError};

use crate::contents::Opened;
use crate::format::open_file;
use crate::input::Input;
use crate::load::{Limits, LoadOptions, Progress};
use crate::{pick, series, zarr};

/// A volume on disk (or in bytes at hand) whose header was read; [`VolumeReader::read`] takes one time step of it.
/// It may be shared among threads and read from several at once.
pub struct VolumeReader<'a> {
    path: PathBuf,
    opened: Opened<'a>,
    grid: Grid,
    options: LoadOptions,
}

impl VolumeReader<'static> {
    /// Opens a file, all files of a folder, or those of a glob (`slices/*.tif`), and checks what they say against
    /// `options`. Slices of one volume are put together; files that are a volume each are time steps, in the order
    /// of the numbers in their names.
    ///
    /// # Errors
    /// A [`VolumeError`] that names the file, the header line where there is one, the cause and the remedy.
    pub fn open(path: &Path, options: &LoadOptions) -> Result<Self, VolumeError> {
        let opened = match zarr::folder(path) {
            // A Zarr folder is one thing, whatever files it has.
            Some(folder) => zarr::open(&folder, options),
            None => match series::files(path)? {
                None => open_file(&Input::file(path)?, options),
                Some(files) => series::open(&files, options),
            },
        };
        let opened = opened.map_err(|error| error.in_file(path))?;
        Self::new(path.to_path_buf(), opened, options)
    }
}

impl<'a> VolumeReader<'a> {
    /// Opens the bytes of a whole file. `name` is the file's name: raw voxels are described by it, and errors name
    /// it. A header that names other files as its data is refused.
    ///
    /// # Errors
    /// As [`VolumeReader::open`].
    pub fn from_bytes(
        name: &str,
        bytes: &'a [u8],
        options: &LoadOptions,
    ) -> Result<Self, VolumeError> {
        let input = Input::memory(name, bytes);
        let opened = open_file(&input, options).map_err(|error| error.in_file(&input.path))?;
        Self::new(input.path, opened, options)
    }

    fn new(path: PathBuf, opened: Opened<'a>, options: &LoadOptions) -> Result<Self, VolumeError> {
        let contents = &opened.contents;
        let has_levels = contents.about.format.contains("Zarr");
        if options.level.is_some_and(|level| level > 0) && !has_levels {
            let trouble = Trouble::new(
                "a file of one level is asked for another",
                "leave the option `level` out, or take the pyramid's folder",
            );
            return Err(VolumeError::Option(trouble).in_file(&path));
        }
        let checked = || {
            let on_sizes = |error: VolumeError| error.on_line(contents.sizes_line);
            options
                .agree(contents.axes.dims(), contents.scalar_type)
                .map_err(on_sizes)?;
            pick::component(contents, options).map_err(on_sizes)?;
            options.place(contents.grid)
        };
        let grid = checked().map_err(|error| error.in_file(&path))?;
        Ok(Self {
            path,
            grid,
            options: options.clone(),
            opened,
        })
    }

    /// What was read of the header, and the way to the voxels.
    pub(crate) fn opened(&self) -> &Opened<'a> {
        &self.opened
    }

    /// How many time steps there are; 1 where the file knows no time.
    #[must_use]
    pub fn step_count(&self) -> u32 {
        self.opened.contents.axes.steps()
    }

    /// Where the samples will lie, with the placement of the options.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The type of the values before a component is picked.
    #[must_use]
    pub fn scalar_type(&self) -> ScalarType {
        self.opened.contents.scalar_type
    }

    /// What the file says beside grid and values.
    #[must_use]
    pub fn about(&self) -> &About {
        &self.opened.contents.about
    }

    /// Reads the volume of a time step; of the first, where `step` is `None`.
    ///
    /// # Errors
    /// As [`VolumeReader::open`]; [`VolumeError::Option`] where there is no such step.
    pub fn read(&self, step: Option<u32>) -> Result<Volume, VolumeError> {
        self.read_reporting(step, self.options.progress.clone())
    }

    /// As [`VolumeReader::read`], reporting elsewhere than the options say.
    ///
    /// # Errors
    /// As [`VolumeReader::read`].
    pub fn read_reporting(
        &self,
        step: Option<u32>,
        progress: Option<Progress>,
    ) -> Result<Volume, VolumeError> {
        let limits = Limits::new(self.options.max_bytes, progress);
        self.read_step(step, &limits)
            .map_err(|error| error.in_file(&self.path))
    }

    fn read_step(&self, step: Option<u32>, limits: &Limits) -> Result<Volume, VolumeError> {
        let contents = &self.opened.contents;
        let index = step.unwrap_or(0);
        let count = self.step_count();
        if index >= count {
            let steps = if count == 1 { "step" } else { "steps" };
            return Err(VolumeError::Option(Trouble::new(
                format!("there is no time step {index}: there are {count} {steps}"),
                format!("name one of 0 to {}", count - 1),
            )));
        }
        let component = pick::component(contents, &self.options)?;
        let values = self.opened.data.read(index, limits)?;
        let taken = pick::take(&contents.axes, values, component, contents.components);
        let values_per_voxel = contents.axes.component_count();
        let about = About {
            picked: component
                .filter(|_| values_per_voxel > 1)
                .map(|component| Picked {
                    component,
                    count: values_per_voxel,
                }),
            step: (count > 1).then(|| Step {
                index,
                count,
                time: contents.times.get(index as usize).copied(),
                unit: contents.time_unit.clone(),
            }),
            ..contents.about.clone()
        };
        let volume = Volume::new(contents.name.clone(), self.grid, taken.voxels)?.with_about(about);
        let volume = match taken.colors {
            Some(colors) => volume.with_colors(colors)?,
            None => volume,
        };
        let others = contents.data_files.iter();
        let mut files: Vec<PathBuf> = others.filter(|file| **file != self.path).cloned().collect();
        // A folder or a pattern is no file itself; bytes at hand have their name.
        if files.is_empty() || self.path.is_file() {
            files.insert(0, self.path.clone());
        }
        let warnings = contents.warnings.iter();
        let warnings = warnings.map(|text| format!("{}: {text}", self.path.display()));
        Ok(volume.with_sources(files, warnings.collect()))
    }
}
