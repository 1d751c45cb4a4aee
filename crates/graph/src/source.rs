//! What a graph draws: the traits of loaded sources and of the kinds that load them.

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

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

/// Where the files of sources are looked for: the graph's own folder first, then folders of data.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folders(Vec<PathBuf>);

impl Folders {
    /// The graph's folder, then the others in their order.
    #[must_use]
    pub fn new(graph: impl Into<PathBuf>, data: &[PathBuf]) -> Self {
        Self(
            std::iter::once(graph.into())
                .chain(data.iter().cloned())
                .collect(),
        )
    }

    /// The first folder's file that is there; where none is, the one in the graph's folder.
    #[must_use]
    pub fn find(&self, path: &str) -> PathBuf {
        let in_folders = || self.0.iter().map(|folder| folder.join(path));
        in_folders()
            .find(|file| file.exists())
            .or_else(|| in_folders().next())
            .unwrap_or_else(|| path.into())
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
