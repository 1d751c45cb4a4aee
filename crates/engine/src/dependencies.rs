//! The files that a picture depends on: what a watcher watches.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use volgraph_graph::is_embedded;
use volgraph_shader::{ShaderFiles, SnapshotFiles};
use volgraph_watch::{Seen, Stamp};

use crate::scene::Scene;

/// Files with what was used of each, and folders.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dependencies {
    /// Every file that was read or looked for in vain.
    pub files: BTreeMap<PathBuf, Seen>,
    /// Folders in which anything may mend what was refused.
    pub folders: BTreeSet<PathBuf>,
}

impl Dependencies {
    /// Those of a scene and the shaders that were read for it.
    #[must_use]
    pub fn of(scene: &Scene, snapshot: &SnapshotFiles) -> Self {
        // What a source says of its own files is older than what else was seen of them, and so the safe side.
        let mut files: BTreeMap<PathBuf, Seen> = shaders(snapshot).collect();
        files.extend(scene.data.clone());
        let mut dependencies = Self {
            files,
            folders: BTreeSet::new(),
        };
        dependencies.note_graph(&scene.path, Some(&scene.text));
        dependencies
    }

    /// Takes note of a graph's text (`None` where it cannot be read) and of what changed, as an attempt finds them
    /// that may end before it knows more. `data` are files of sources.
    pub(crate) fn note(
        &mut self,
        graph: &Path,
        text: Option<&String>,
        changed: &BTreeSet<PathBuf>,
        data: &BTreeMap<PathBuf, Seen>,
        snapshot: &SnapshotFiles,
    ) {
        for path in changed {
            match self.files.get_mut(path) {
                // Not read here: it may be large.
                Some(seen) if data.contains_key(path) => *seen = as_it_is(path),
                // What a snapshot has read it tells below.
                Some(Seen::Digest(_) | Seen::Absent) => {
                    let _ = snapshot.read(path);
                }
                Some(seen @ (Seen::Stamp(_) | Seen::Unsure)) => *seen = as_it_is(path),
                None => {}
            }
        }
        self.files.extend(shaders(snapshot));
        self.note_graph(graph, text);
    }

    /// Takes note of a graph's text; `None` where it cannot be read.
    pub(crate) fn note_graph(&mut self, graph: &Path, text: Option<&String>) {
        if is_embedded(graph) {
            return;
        }
        let text = text.map_or_else(|| as_it_is(graph), |text| Seen::bytes(text.as_bytes()));
        self.files.insert(graph.to_path_buf(), text);
    }

    /// Adds what another attempt has seen of files that are not known here.
    pub(crate) fn add(&mut self, other: Self) {
        for (path, seen) in other.files {
            self.files.entry(path).or_insert(seen);
        }
        self.folders.extend(other.folders);
    }

    /// What loads of sources that began at `began` looked for and found or not, where one failed.
    pub(crate) fn note_failed_source(&mut self, asked: &BTreeSet<PathBuf>, began: SystemTime) {
        for path in asked.iter().filter(|path| !is_embedded(path)) {
            self.files.insert(path.clone(), data_since(path, began));
            // Its header may name other files: anything beside it may mend it.
            if let (true, Some(folder)) = (path.exists(), path.parent()) {
                self.folders.insert(folder.to_path_buf());
            }
        }
    }
}

fn shaders(snapshot: &SnapshotFiles) -> impl Iterator<Item = (PathBuf, Seen)> {
    snapshot.seen().into_iter().map(|(path, digest)| {
        // A file that is there and could not be read: whatever comes after what it is now.
        let seen = digest.map_or_else(|| as_it_is(&path), Seen::Digest);
        (path, seen)
    })
}

pub(crate) fn as_it_is(path: &Path) -> Seen {
    Stamp::of(path).map_or(Seen::Absent, Seen::Stamp)
}

/// File systems' clocks are this coarse.
const CLOCK: Duration = Duration::from_millis(10);

/// What was used of a file of data whose reading began at `began`, and of which there is no stamp from before that: one
/// that was written meanwhile is read again. A time in the future tells nothing of when that was.
pub(crate) fn data_since(path: &Path, began: SystemTime) -> Seen {
    let now = SystemTime::now();
    let is_young = |at: SystemTime| at + CLOCK >= began && at <= now;
    match Stamp::of(path) {
        Ok(stamp) if stamp.modified().is_some_and(is_young) => Seen::Unsure,
        Ok(stamp) => Seen::Stamp(stamp),
        Err(_) => Seen::Unsure,
    }
}
