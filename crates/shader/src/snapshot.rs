//! Files as they were at one moment.
//!
//! Linking a graph reads some files many times, while their author may be saving them. A snapshot asks for each path
//! once, for its text and for its canonical path, and gives the same answer ever after, so that all programs of a
//! plan see one state of the disk, and a plan can be made again from the state that worked while the disk holds one
//! that does not. A [`SnapshotFiles::fork`] is for an attempt that may be refused: what it reads beyond is its own.
//! What was read, and what was looked for in vain, is what a watcher has to watch.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::{fmt, io};

use crate::ShaderFiles;

/// A store that reads each path once from the store below. Clones share what they have read.
#[derive(Clone)]
pub struct SnapshotFiles {
    below: Arc<dyn ShaderFiles>,
    read: Arc<Mutex<BTreeMap<PathBuf, Answer>>>,
    canonical: Arc<Mutex<BTreeMap<PathBuf, PathBuf>>>,
}

/// A text, or why there is none. `io::Error` cannot be cloned.
type Answer = Result<String, (io::ErrorKind, String)>;

impl SnapshotFiles {
    /// Nothing read yet.
    #[must_use]
    pub fn new(below: Arc<dyn ShaderFiles>) -> Self {
        Self {
            below,
            read: Arc::default(),
            canonical: Arc::default(),
        }
    }

    /// Another snapshot that begins with what this one has read.
    #[must_use]
    pub fn fork(&self) -> Self {
        Self {
            below: Arc::clone(&self.below),
            read: Arc::new(Mutex::new(self.answers().clone())),
            canonical: Arc::new(Mutex::new(locked(&self.canonical).clone())),
        }
    }

    /// Every path that was asked for → BLAKE3 of its text; `None` where there was nothing to read.
    #[must_use]
    pub fn seen(&self) -> BTreeMap<PathBuf, Option<[u8; 32]>> {
        self.answers()
            .iter()
            .map(|(path, answer)| {
                let digest = answer
                    .as_ref()
                    .ok()
                    .map(|text| *blake3::hash(text.as_bytes()).as_bytes());
                (path.clone(), digest)
            })
            .collect()
    }

    fn answers(&self) -> MutexGuard<'_, BTreeMap<PathBuf, Answer>> {
        locked(&self.read)
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ShaderFiles for SnapshotFiles {
    fn read(&self, path: &Path) -> io::Result<String> {
        let mut answers = self.answers();
        let answer = answers.entry(path.to_path_buf()).or_insert_with(|| {
            self.below
                .read(path)
                .map_err(|error| (error.kind(), error.to_string()))
        });
        answer
            .clone()
            .map_err(|(kind, reason)| io::Error::new(kind, reason))
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<String>> {
        self.below.list(folder)
    }

    fn canonical(&self, path: &Path) -> PathBuf {
        let mut known = locked(&self.canonical);
        let canonical = known
            .entry(path.to_path_buf())
            .or_insert_with(|| self.below.canonical(path));
        canonical.clone()
    }
}

impl fmt::Debug for SnapshotFiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SnapshotFiles")
            .field("read", &self.answers().keys())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DiskFiles;

    #[test]
    fn what_was_read_once_stays_and_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let (there, gone) = (folder.path().join("a.wgsl"), folder.path().join("b.wgsl"));
        std::fs::write(&there, "one").unwrap();
        let snapshot = SnapshotFiles::new(Arc::new(DiskFiles));
        assert_eq!(snapshot.read(&there).unwrap(), "one");
        let error = snapshot.read(&gone).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
        std::fs::write(&there, "two").unwrap();
        std::fs::write(&gone, "there now").unwrap();
        assert_eq!(snapshot.read(&there).unwrap(), "one");
        assert!(snapshot.read(&gone).is_err());
        let seen = snapshot.seen();
        assert_eq!(seen[&there], Some(*blake3::hash(b"one").as_bytes()));
        assert_eq!(seen[&gone], None);
        let later = SnapshotFiles::new(Arc::new(DiskFiles));
        assert_eq!(later.read(&there).unwrap(), "two");
    }

    #[test]
    fn what_a_fork_reads_is_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a.wgsl"), folder.path().join("b.wgsl"));
        std::fs::write(&a, "one").unwrap();
        std::fs::write(&b, "one").unwrap();
        let snapshot = SnapshotFiles::new(Arc::new(DiskFiles));
        snapshot.read(&a).unwrap();
        let fork = snapshot.fork();
        std::fs::write(&a, "two").unwrap();
        assert_eq!(fork.read(&a).unwrap(), "one");
        assert_eq!(fork.read(&b).unwrap(), "one");
        std::fs::write(&b, "two").unwrap();
        assert_eq!(snapshot.read(&b).unwrap(), "two");
        assert_eq!(fork.read(&b).unwrap(), "one");
    }

    #[test]
    #[cfg(unix)]
    fn one_file_by_two_names_stays_one_when_it_goes() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("a.wgsl"), folder.path().join("b.wgsl"));
        std::fs::write(&file, "one").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        let snapshot = SnapshotFiles::new(Arc::new(DiskFiles));
        assert_eq!(snapshot.canonical(&link), snapshot.canonical(&file));
        std::fs::remove_file(&link).unwrap();
        assert_eq!(snapshot.canonical(&link), snapshot.canonical(&file));
    }
}
