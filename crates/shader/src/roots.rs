//! Finds shader files by the paths that authors write.
//!
//! A path in an `#import` is looked for beside the importing file, then in each root, last in the embedded
//! set, which is one more root named `embedded:`. A file is shown by the path that it was found at, from the
//! current folder where it lies below that.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fmt, io};

use include_dir::Dir;

use crate::files::{DiskFiles, ShaderFiles, plain};

/// The root of the embedded set.
const EMBEDDED: &str = "embedded:";

/// The folders that imports are looked up in, and the store they lie in. Relative import paths are tried
/// beside the importing file, then in each root in order, last in the embedded set.
#[derive(Clone)]
pub struct ShaderRoots {
    files: Arc<dyn ShaderFiles>,
    roots: Vec<PathBuf>,
    embedded: Option<&'static Dir<'static>>,
}

/// A file that a path led to.
pub(crate) struct Found {
    /// One path for one file.
    pub canonical: PathBuf,
    /// The file as its author would name it; its parent is where its own imports start.
    pub display: PathBuf,
    pub text: String,
}

/// Why a path led to no file.
pub(crate) enum NotFound {
    /// No folder has it; the folders' paths tried.
    Nowhere(Vec<PathBuf>),
    /// This file is there and cannot be read.
    Unreadable(PathBuf, io::Error),
}

impl ShaderRoots {
    /// No roots yet, files from `files`.
    #[must_use]
    pub fn new(files: Arc<dyn ShaderFiles>) -> Self {
        Self {
            files,
            roots: Vec::new(),
            embedded: None,
        }
    }

    /// No roots yet, files from the disk.
    #[must_use]
    pub fn on_disk() -> Self {
        Self::new(Arc::new(DiskFiles))
    }

    /// Adds a root folder after those there are.
    #[must_use]
    pub fn root(mut self, folder: impl Into<PathBuf>) -> Self {
        self.roots.push(folder.into());
        self
    }

    /// Sets the embedded set, tried last; its files are named `embedded:/lib/ray.wgsl`.
    #[must_use]
    pub fn embedded(mut self, files: &'static Dir<'static>) -> Self {
        self.embedded = Some(files);
        self
    }

    /// The choices there are for a slot: the names of the files `slot/<slot>/<name>.wgsl` of all roots, sorted.
    #[must_use]
    pub fn choices(&self, slot: &str) -> Vec<String> {
        let folder = Path::new("slot").join(slot);
        let names = self.names_in(&self.folders(None), &folder);
        names
            .iter()
            .filter_map(|name| Some(name.strip_suffix(".wgsl")?.to_owned()))
            .collect()
    }

    /// The paths of the `.wgsl` files directly in the folder `folder` (such as `lib`, `node`, `slot/clip`) of
    /// all roots, relative to the roots, sorted, each once.
    #[must_use]
    pub fn list(&self, folder: impl AsRef<Path>) -> Vec<PathBuf> {
        let folder = folder.as_ref();
        let names = self.names_in(&self.folders(None), folder);
        names.iter().map(|name| folder.join(name)).collect()
    }

    /// The folders to try, in order: `first`, the roots, the embedded set.
    pub(crate) fn folders(&self, first: Option<&Path>) -> Vec<PathBuf> {
        let embedded = self.embedded.map(|_| PathBuf::from(EMBEDDED));
        first
            .map(Path::to_path_buf)
            .into_iter()
            .chain(self.roots.iter().cloned())
            .chain(embedded)
            .collect()
    }

    /// The names of the `.wgsl` files in `below` of each of these folders.
    pub(crate) fn names_in(&self, folders: &[PathBuf], below: &Path) -> BTreeSet<String> {
        folders
            .iter()
            .flat_map(|folder| self.list_one(&plain(&folder.join(below))))
            .filter(|name| name.ends_with(".wgsl"))
            .collect()
    }

    /// The first of these folders' files of this path.
    pub(crate) fn find(&self, folders: &[PathBuf], path: &Path) -> Result<Found, NotFound> {
        let mut tried = Vec::new();
        for folder in folders {
            let display = self.display(&folder.join(path));
            if tried.contains(&display) {
                continue;
            }
            match self.read(&display) {
                Ok(text) => {
                    let canonical = if display.starts_with(EMBEDDED) {
                        display.clone()
                    } else {
                        self.files.canonical(&display)
                    };
                    return Ok(Found {
                        canonical,
                        display,
                        text,
                    });
                }
                Err(error) if is_absence(&error) => tried.push(display),
                Err(error) => return Err(NotFound::Unreadable(display, error)),
            }
        }
        Err(NotFound::Nowhere(tried))
    }

    fn read(&self, path: &Path) -> io::Result<String> {
        let Ok(below) = path.strip_prefix(EMBEDDED) else {
            return self.files.read(path);
        };
        let file = self.embedded.and_then(|embedded| embedded.get_file(below));
        let file = file.ok_or(io::ErrorKind::NotFound)?;
        let text = file.contents_utf8().ok_or(io::ErrorKind::InvalidData)?;
        Ok(text.to_owned())
    }

    fn list_one(&self, folder: &Path) -> Vec<String> {
        let Ok(below) = folder.strip_prefix(EMBEDDED) else {
            return self.files.list(folder).unwrap_or_default();
        };
        let dir = self.embedded.and_then(|embedded| {
            if below.as_os_str().is_empty() {
                Some(embedded)
            } else {
                embedded.get_dir(below)
            }
        });
        dir.map(|dir| {
            dir.files()
                .filter_map(|file| Some(file.path().file_name()?.to_str()?.to_owned()))
                .collect()
        })
        .unwrap_or_default()
    }

    /// A path as people would name it: without detours, and from the current folder where it lies below it.
    fn display(&self, path: &Path) -> PathBuf {
        let path = plain(path);
        let here = std::env::current_dir().ok();
        match here.and_then(|here| path.strip_prefix(here).ok().map(Path::to_path_buf)) {
            Some(below) => below,
            None => path,
        }
    }
}

impl fmt::Debug for ShaderRoots {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ShaderRoots")
            .field("roots", &self.roots)
            .field("embedded", &self.embedded.is_some())
            .finish_non_exhaustive()
    }
}

fn is_absence(error: &io::Error) -> bool {
    use io::ErrorKind as K;
    matches!(
        error.kind(),
        K::NotFound | K::NotADirectory | K::InvalidFilename
    ) || (error.kind() == K::InvalidInput)
}
