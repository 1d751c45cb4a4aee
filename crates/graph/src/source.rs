//! What a graph draws: the traits of loaded sources and of the kinds that load them.

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
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

/// Where the files of sources are looked for: the graph's own folder first, then folders of data. Every path that was
/// asked for is remembered, so that a watcher knows what would have served.
#[derive(Clone, Debug, Default)]
pub struct Folders {
    folders: Vec<PathBuf>,
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
            asked: Arc::default(),
        }
    }

    /// The first folder's file that is there; where none is, the one in the graph's folder.
    #[must_use]
    pub fn find(&self, path: &str) -> PathBuf {
        let mut asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        let mut first = None;
        for folder in &self.folders {
            let file = folder.join(path);
            asked.insert(file.clone());
            if file.exists() {
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
