//! Boxes of voxels of any level of an image, for who does not want all of it.

use std::path::{Path, PathBuf};

use volgraph_volume::{Component, Grid, ScalarType, Trouble, VolumeError, Voxels};

use super::array::Box as Region;
use super::image::Image;
use super::parts;
use crate::axes::Axes;
use crate::load::{Limits, LoadOptions};

/// A level of a [`Pyramid`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Where its samples lie, and how many there are.
    pub grid: Grid,
    /// Voxels of what is read at once, along x, y and z; a region along its borders costs least.
    pub chunk: [u32; 3],
    /// The type of its voxels.
    pub scalar_type: ScalarType,
}

/// An image of a Zarr folder, of which regions are read. It may be shared among threads and read from several at
/// once.
pub struct Pyramid {
    folder: PathBuf,
    levels: Vec<(Image, Level)>,
    step: u32,
    component: u64,
    limits: Limits,
}

impl Pyramid {
    /// Opens the part that the options name; of several time steps and components, the ones they name, or the first.
    /// A region may have as many bytes as the options allow (`max_bytes`).
    ///
    /// # Errors
    /// A [`VolumeError`] that names the file, the cause and the remedy.
    pub fn open(path: &Path, options: &LoadOptions) -> Result<Self, VolumeError> {
        let opened = || {
            let (store, folder) = super::place(path)?.ok_or_else(|| {
                VolumeError::UnknownFormat(Trouble::new(
                    "is no Zarr folder",
                    "give a folder with zarr.json, .zgroup or .zarray in it",
                ))
            })?;
            let part = parts::find(&store, &folder, options.part.as_deref())?;
            let first = Image::open(&store, &folder, &part, 0)?;
            let (step, component) = chosen(&first, options)?;
            let count = u32::try_from(first.level_count()).unwrap_or(u32::MAX);
            let mut levels = vec![level(first, options)?];
            for number in 1..count {
                levels.push(level(
                    Image::open(&store, &folder, &part, number)?,
                    options,
                )?);
            }
            Ok(Self {
                folder,
                levels,
                step,
                component,
                limits: Limits::new(options.max_bytes, None),
            })
        };
        opened().map_err(|error: VolumeError| error.in_file(path))
    }

    /// The metadata of level 0 as it is written, which tells the image from others.
    pub(crate) fn metadata(&self) -> Result<Vec<u8>, VolumeError> {
        let Some((Image { array, .. }, _)) = self.levels.first() else {
            return Ok(Vec::new());
        };
        let file = &array.meta.file;
        let open = array.store.open(file, super::metadata::LONGEST)?;
        open.map_or(Ok(Vec::new()), |open| {
            open.read_all().map_err(|error| error.in_file(file))
        })
    }

    /// The levels, finest first.
    pub fn levels(&self) -> impl ExactSizeIterator<Item = &Level> {
        self.levels.iter().map(|(_, level)| level)
    }

    /// The voxels of a box of a level, x fastest; `origin` is its first index and `size` its voxels along x, y and z.
    /// Chunks that are not there have the array's fill value.
    ///
    /// # Errors
    /// [`VolumeError::Option`] where the level or the box is not there; what may be wrong with chunks otherwise.
    pub fn read_region(
        &self,
        level: usize,
        origin: [u32; 3],
        size: [u32; 3],
    ) -> Result<Voxels, VolumeError> {
        self.region(level, origin, size)
            .map_err(|error| error.in_file(&self.folder))
    }

    fn region(
        &self,
        level: usize,
        origin: [u32; 3],
        size: [u32; 3],
    ) -> Result<Voxels, VolumeError> {
        let refuse =
            |cause: String, remedy: &str| Err(VolumeError::Option(Trouble::new(cause, remedy)));
        let Some((image, known)) = self.levels.get(level) else {
            let count = self.levels.len();
            return refuse(
                format!("there is no level {level} of {count}"),
                "name one that is there",
            );
        };
        let dims = known.grid.dims;
        let inside = |axis: usize| {
            size[axis] > 0
                && u64::from(origin[axis]) + u64::from(size[axis]) <= u64::from(dims[axis])
        };
        if !(0..3).all(inside) {
            return refuse(
                format!("a region from {origin:?} of {size:?} voxels is not inside of {dims:?}"),
                "ask for at least one voxel along each axis, inside of the level",
            );
        }
        let mut region = image.of_component(&image.whole(self.step), self.component);
        for (i, &axis) in image.space.iter().enumerate() {
            (region.origin[axis], region.size[axis]) = (origin[i].into(), size[i].into());
        }
        let voxels = image.array.read(&region, &region, &self.limits)?;
        // The axes of space may stand in any order.
        let Region { size, .. } = region;
        let rank = size.len();
        let axes = Axes::new(
            size.into_iter().rev().collect(),
            image.space.iter().map(|&axis| rank - 1 - axis).collect(),
        )?;
        Ok(axes.select(voxels, 0))
    }
}

fn chosen(image: &Image, options: &LoadOptions) -> Result<(u32, u64), VolumeError> {
    let refuse = |cause: String, count: u64| {
        Err(VolumeError::Option(Trouble::new(
            cause,
            format!("name one of 0 to {}", count.saturating_sub(1)),
        )))
    };
    let step = options.time.unwrap_or(0);
    if u64::from(step) >= image.steps() {
        return refuse(format!("there is no time step {step}"), image.steps());
    }
    let count = image.axes()?.component_count();
    let component = match options.component {
        None => 0,
        Some(Component::Index(index)) => index.into(),
        Some(other) => return refuse(format!("regions have one component, not {other}"), count),
    };
    if component >= count {
        return refuse(format!("there is no component {component}"), count);
    }
    Ok((step, component))
}

fn level(image: Image, options: &LoadOptions) -> Result<(Image, Level), VolumeError> {
    let axes = image.axes()?;
    axes.count()?;
    let dims = axes.dims();
    let mut grid = image.grid(dims)?;
    grid.node_centred |= options.node_centred;
    let mut chunk = [1; 3];
    for (i, &axis) in image.space.iter().enumerate() {
        let size = u32::try_from(image.array.chunk()[axis]).unwrap_or(u32::MAX);
        chunk[i] = size.min(dims[i]);
    }
    let scalar_type = image.array.meta.element.scalar_type;
    let level = Level {
        grid,
        chunk,
        scalar_type,
    };
    Ok((image, level))
}
