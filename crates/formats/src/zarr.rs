//! Zarr v2 and v3 in a folder, with or without OME-Zarr's metadata (0.1 to 0.5).
//!
//! A folder with `zarr.json`, `.zgroup` or `.zarray` is one thing: `parts` finds its images and arrays and takes the
//! one that is asked for; `image` makes axes and placement of it; `array` reads boxes of voxels out of chunks, with
//! `run` brings them in, with the bounds on what they may be in `codecs` and `packed`. Level and time step are read alone. [`Pyramid`] is the way in for
//! who wants single boxes of several levels.
//! Source: <https://zarr-specs.readthedocs.io/>, <https://ngff.openmicroscopy.org/0.5/>.

mod array;
mod codecs;
mod element;
mod image;
mod metadata;
mod ome;
mod packed;
mod parts;
mod pyramid;
mod run;

use std::path::{Path, PathBuf};

use volgraph_volume::{Component, VolumeError, Voxels};

pub use pyramid::{Level, Pyramid};

use crate::contents::{Data, Opened};
use crate::load::{Limits, LoadOptions};
use image::Image;

/// Files that make a folder a Zarr one.
const MARKS: [&str; 4] = ["zarr.json", ".zgroup", ".zarray", ".zattrs"];

/// Whether a path is a Zarr folder.
pub(crate) fn is_zarr(path: &Path) -> bool {
    MARKS.iter().any(|mark| path.join(mark).is_file())
}

/// The Zarr folder that a path means: itself, or that of one of its metadata files.
pub(crate) fn folder(path: &Path) -> Option<PathBuf> {
    if path.is_dir() {
        return is_zarr(path).then(|| path.to_path_buf());
    }
    let name = path.file_name()?.to_str()?;
    let parent = path
        .parent()
        .filter(|_| MARKS.contains(&name) && path.is_file())?;
    Some(if parent.as_os_str().is_empty() {
        ".".into()
    } else {
        parent.to_path_buf()
    })
}

/// Opens one level of what the options name.
pub(crate) fn open(folder: &Path, options: &LoadOptions) -> Result<Opened<'static>, VolumeError> {
    let part = parts::find(folder, options.part.as_deref())?;
    let level = options.level.unwrap_or(0);
    let image = Image::open(folder, &part, level)?;
    let contents = image.contents(folder, &part)?;
    let component = match options.component {
        Some(Component::Index(index)) => Some(index.into()),
        _ => None,
    };
    Ok(Opened {
        contents,
        data: Box::new(Source { image, component }),
    })
}

/// The voxels of an image.
struct Source {
    image: Image,
    /// The only component whose chunks are needed.
    component: Option<u64>,
}

impl Data for Source {
    fn read(&self, step: u32, limits: &Limits) -> Result<Voxels, VolumeError> {
        let wanted = self.image.whole(step);
        let needed = match self.component {
            Some(component) => self.image.of_component(&wanted, component),
            None => wanted.clone(),
        };
        self.image.array.check_there(&wanted, &needed)?;
        self.image.array.read(&wanted, &needed, limits)
    }
}
