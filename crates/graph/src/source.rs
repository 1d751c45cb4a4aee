//! What a graph draws: the traits of loaded sources and of the kinds that load them.

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use include_dir::Dir;
use volgraph_report::Findings;
use volgraph_shader::{ParamSpec, ParamValue};

use crate::{Digest, PortType};

/// A loaded source: a volume, a transfer function, an image, or anything else a node kind can downcast.
pub trait Source: Send + Sync + fmt::Debug {
    /// What its single output port gives.
    fn ty(&self) -> PortType;

    /// Changes whenever its content does.
    fn digest(&self) -> Digest;

    /// One line: what it is.
    fn summary(&self) -> String;

    /// The files it was read from.
    fn files(&self) -> Vec<PathBuf>;

    /// The corners of its box in world space, for cameras that fit; empty where it has none.
    fn corners(&self) -> Vec<DVec3> {
        Vec::new()
    }

    /// What the user should know: voxels that are not numbers, say.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Itself, for a node kind that knows the type.
    fn as_any(&self) -> &dyn Any;
}

/// Reports how much of a long read is done: (bytes so far, bytes in all or 0 where unknown).
pub type Progress<'p> = &'p (dyn Fn(u64, u64) + Sync);

/// The folder of the graphs that are part of the program, as paths name it.
pub const EMBEDDED_GRAPHS: &str = "embedded:/graphs";

/// What all paths of files inside the program start with.
const EMBEDDED: &str = "embedded:";

/// Where the files of sources are looked for: the graph's own folder first, then folders of data. Every path that was
/// asked for is remembered, so that a watcher knows what would have served.
///
/// A program may carry files in itself, named `embedded:/graphs/…`. They are read where a path says so, or where the
/// graph is one of them; never in place of a file that is missing on disk.
#[derive(Clone, Debug, Default)]
pub struct Folders {
    folders: Vec<PathBuf>,
    embedded: Option<&'static Dir<'static>>,
    asked: Arc<Mutex<BTreeSet<PathBuf>>>,
}

impl Folders {
    /// The graph's folder, then the others in their order.
    #[must_use]
    pub fn new(graph: impl Into<PathBuf>, data: &[PathBuf]) -> Self {
        Self {
            folders: std::iter::once(graph.into())
                .chain(data.iter().cloned())
                .collect(),
            embedded: None,
            asked: Arc::default(),
        }
    }

    /// Sets the files that the program carries: the folder [`EMBEDDED_GRAPHS`].
    #[must_use]
    pub fn embedded(mut self, files: &'static Dir<'static>) -> Self {
        self.embedded = Some(files);
        self
    }

    /// The same, and before all others the folder of a file that names more of them.
    #[must_use]
    pub fn beside(&self, file: &Path) -> Self {
        let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
        let mut beside = self.clone();
        beside.folders.insert(0, folder);
        beside
    }

    /// The first folder's file that is there; where none is, the one in the graph's folder. A path that starts with
    /// `embedded:` is taken as it is.
    #[must_use]
    pub fn find(&self, path: &str) -> PathBuf {
        if is_embedded(Path::new(path)) {
            return path.into();
        }
        let is_there = |file: &Path| {
            if is_embedded(file) {
                self.embedded_bytes(file).is_some()
            } else {
                is_there(file)
            }
        };
        let mut asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        let mut first = None;
        for folder in &self.folders {
            let file = folder.join(path);
            asked.insert(file.clone());
            if is_there(&file) {
                return file;
            }
            first = first.or(Some(file));
        }
        first.unwrap_or_else(|| path.into())
    }

    /// The files that were asked for, those before the one that was found included.
    #[must_use]
    pub fn asked(&self) -> BTreeSet<PathBuf> {
        let asked = self.asked.lock();
        asked.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The content of a file that the program carries; `None` for any other path.
    #[must_use]
    pub fn embedded_bytes(&self, file: &Path) -> Option<&'static [u8]> {
        let below = file.strip_prefix(EMBEDDED_GRAPHS).ok()?;
        Some(self.embedded?.get_file(below)?.contents())
    }

    /// The path of the file that the program carries under this name, such as `transfer/engine.ron`: for a remedy
    /// where a file of the graph is missing.
    #[must_use]
    pub fn embedded_twin(&self, path: &str) -> Option<PathBuf> {
        let twin = Path::new(EMBEDDED_GRAPHS).join(path);
        self.embedded_bytes(&twin).map(|_| twin)
    }
}

/// Whether a file or folder is there, or one at least that a pattern such as `slices/*.tif` names.
#[must_use]
pub fn is_there(file: &Path) -> bool {
    if file.exists() {
        return true;
    }
    let pattern = file.to_str().filter(|text| text.contains(['*', '?', '[']));
    let matches = pattern.and_then(|pattern| glob::glob(pattern).ok());
    matches.is_some_and(|mut matches| matches.any(|file| file.is_ok()))
}

/// Whether a path names a file inside the program: `embedded:/…`.
#[must_use]
pub fn is_embedded(path: &Path) -> bool {
    path.starts_with(EMBEDDED)
}

/// A kind of source.
pub trait SourceKind: Send + Sync {
    /// Its name, such as `volume`.
    fn name(&self) -> &'static str;

    /// What it gives, one sentence.
    fn doc(&self) -> &'static str;

    /// The type of its output.
    fn ty(&self) -> PortType;

    /// Its fields. A field whose default is an empty text or vector may be left out without a meaning of its own.
    fn params(&self) -> Vec<ParamSpec>;

    /// Reads it. `params` are checked against [`Self::params`] and hold given values alone; paths are looked up in
    /// `folders`.
    ///
    /// # Errors
    /// Everything wrong with its files; findings without a place get the source's place in the graph file.
    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        folders: &Folders,
        progress: Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings>;
}
