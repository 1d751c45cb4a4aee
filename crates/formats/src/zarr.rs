//! Zarr v2 and v3 in a folder or a zip archive, with or without OME-Zarr's metadata (0.1 to 0.5).
//!
//! A folder with `zarr.json`, `.zgroup` or `.zarray` is one thing: `parts` finds its images and arrays and takes the
//! one that is asked for; `image` makes axes and placement of it; `array` reads boxes of voxels out of chunks, which
//! `run` brings in, with the bounds on what they may be in `codecs` and `packed`. All of them ask a `store` for files,
//! which is a folder or a `zip`. Level and time step are read alone. [`Pyramid`] is the way in for who wants single
//! boxes of several levels.
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
mod store;
mod zip;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use volgraph_volume::{Component, VolumeError, Voxels};

pub use pyramid::{Level, Pyramid};

use crate::contents::{Data, Opened};
use crate::format::Head;
use crate::input::Input;
use crate::load::{Limits, LoadOptions};
use image::Image;
use store::Store;
use zip::Zip;

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
    open_in(&Store::Folder, folder, options)
}

/// Whether a file is an archive that has a hierarchy by its name, or by its first entry.
pub(crate) fn is_zip(head: &Head) -> bool {
    let by_name = || ENDINGS.iter().any(|ending| head.ends_with(ending));
    let first = zip::first_name(&head.bytes).and_then(|name| name.rsplit('/').next());
    zip::is_zip(&head.bytes) && (by_name() || first.is_some_and(|name| MARKS.contains(&name)))
}

/// Endings of archives that have a hierarchy.
pub(crate) const ENDINGS: &[&str] = &[".zarr.zip", ".ozx"];

/// As [`open`], of a hierarchy in a zip archive.
pub(crate) fn open_zip<'a>(
    input: &Input<'a>,
    options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let zip = Zip::open(input)?;
    let root = zip.root()?;
    open_in(&Store::Zip(Arc::new(zip)), &root, options)
}

/// Whether a path has a hierarchy, in a folder or an archive.
pub(crate) fn is_hierarchy(path: &Path) -> bool {
    matches!(place(path), Ok(Some(_)))
}

/// Where a path's hierarchy lies, if it has one: the folder, or the one inside of an archive.
fn place(path: &Path) -> Result<Option<(Store, PathBuf)>, VolumeError> {
    if let Some(folder) = folder(path) {
        return Ok(Some((Store::Folder, folder)));
    }
    if !path.is_file() {
        return Ok(None);
    }
    let input = Input::file(path)?;
    if !zip::is_zip(&input.head(4)?) {
        return Ok(None);
    }
    let zip = Zip::open(&input)?;
    let root = zip.root()?;
    Ok(Some((Store::Zip(Arc::new(zip)), root)))
}

fn open_in(
    store: &Store,
    folder: &Path,
    options: &LoadOptions,
) -> Result<Opened<'static>, VolumeError> {
    let part = parts::find(store, folder, options.part.as_deref())?;
    let level = options.level.unwrap_or(0);
    let image = Image::open(store, folder, &part, level)?;
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
