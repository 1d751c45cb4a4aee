//! The files that a picture depends on: what a watcher watches.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use volgraph_shader::{ShaderFiles, SnapshotFiles};

use crate::scene::Scene;

/// Files, with what was used of each, and folders.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dependencies {
    /// Files of text → BLAKE3 of the text that was used; `None` for one that was looked for in vain.
    pub texts: BTreeMap<PathBuf, Option<[u8; 32]>>,
    /// Files of sources.
    pub data: BTreeSet<PathBuf>,
    /// Folders in which anything may mend what was refused.
    pub folders: BTreeSet<PathBuf>,
}

impl Dependencies {
    /// Those of a scene and the shaders that were read for it.
    #[must_use]
    pub fn of(scene: &Scene, snapshot: &SnapshotFiles) -> Self {
        let mut texts = snapshot.seen();
        texts.insert(scene.path.clone(), Some(digest(&scene.text)));
        let data = scene.sources.values().flat_map(|source| source.files());
        Self {
            texts,
            data: data.collect(),
            folders: BTreeSet::new(),
        }
    }

    /// Takes note of a graph's text (`None` where it cannot be read) and of what changed, as an attempt finds them
    /// that may end before it knows more.
    pub(crate) fn note(
        &mut self,
        graph: &Path,
        text: Option<&str>,
        changed: &BTreeSet<PathBuf>,
        snapshot: &SnapshotFiles,
    ) {
        for path in changed.iter().filter(|path| self.texts.contains_key(*path)) {
            // What the snapshot has read it tells below.
            let _ = snapshot.read(path);
        }
        self.texts.extend(snapshot.seen());
        self.texts.insert(graph.to_path_buf(), text.map(digest));
    }
}

fn digest(text: &str) -> [u8; 32] {
    *blake3::hash(text.as_bytes()).as_bytes()
}
