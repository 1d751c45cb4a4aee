//! Where shader files come from: the disk, memory over the disk, and the copy inside the binary.
//!
//! A store ([`ShaderFiles`]) reads, lists and says which paths are one file; [`crate::ShaderRoots`] asks it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::{fmt, fs, io};

/// The largest file that is read, in bytes; a shader is thousands of times smaller.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// A store of text files. Paths are as on a disk: absolute, or relative to the current folder.
pub trait ShaderFiles: Send + Sync {
    /// The text of a file.
    ///
    /// # Errors
    /// What the store says; `NotFound` makes the linker try the next folder.
    fn read(&self, path: &Path) -> io::Result<String>;

    /// The names of the files directly in a folder, in any order; for suggestions.
    ///
    /// # Errors
    /// What the store says; the linker then suggests nothing.
    fn list(&self, folder: &Path) -> io::Result<Vec<String>>;

    /// One path for one file, however it was reached; where the store knows no better, the path with `.` and
    /// `..` taken out.
    fn canonical(&self, path: &Path) -> PathBuf;
}

/// The disk.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiskFiles;

impl ShaderFiles for DiskFiles {
    fn read(&self, path: &Path) -> io::Result<String> {
        // A folder, pipe or device is no shader, and reading it might never end.
        let meta = fs::metadata(path)?;
        if !meta.is_file() {
            return Err(io::ErrorKind::NotFound.into());
        }
        if meta.len() > MAX_FILE_BYTES {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                format!(
                    "it has {} bytes, more than the {MAX_FILE_BYTES} that a shader may have",
                    meta.len()
                ),
            ));
        }
        fs::read_to_string(path)
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<String>> {
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        let mut names = Vec::new();
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            if entry.path().is_file()
                && let Ok(name) = entry.file_name().into_string()
            {
                names.push(name);
            }
        }
        Ok(names)
    }

    fn canonical(&self, path: &Path) -> PathBuf {
        let path = plain(path);
        let path = if path.as_os_str().is_empty() {
            PathBuf::from(".")
        } else {
            path
        };
        // A file that is not there yet (an unsaved buffer) still lies in a folder that is.
        let in_folder = || {
            let path = std::path::absolute(&path)?;
            match (path.parent(), path.file_name()) {
                (Some(folder), Some(name)) => Ok(fs::canonicalize(folder)?.join(name)),
                _ => Ok(path),
            }
        };
        fs::canonicalize(&path)
            .or_else(|_: io::Error| in_folder())
            .or_else(|_: io::Error| std::path::absolute(&path))
            .unwrap_or(path)
    }
}

/// Texts in memory over another store: an editor's unsaved buffers, or a test's files.
#[derive(Clone, Default)]
pub struct MemoryFiles {
    /// By their canonical paths.
    texts: BTreeMap<PathBuf, String>,
    below: Option<Arc<dyn ShaderFiles>>,
}

impl MemoryFiles {
    /// Nothing in memory, and nothing below it.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Nothing in memory yet, over `below`.
    #[must_use]
    pub fn over(below: Arc<dyn ShaderFiles>) -> Self {
        Self {
            texts: BTreeMap::new(),
            below: Some(below),
        }
    }

    /// Adds or replaces a text.
    #[must_use]
    pub fn with(mut self, path: impl AsRef<Path>, text: impl Into<String>) -> Self {
        let path = self.canonical(path.as_ref());
        self.texts.insert(path, text.into());
        self
    }
}

impl ShaderFiles for MemoryFiles {
    fn read(&self, path: &Path) -> io::Result<String> {
        match (self.texts.get(&self.canonical(path)), &self.below) {
            (Some(text), _) => Ok(text.clone()),
            (None, Some(below)) => below.read(path),
            (None, None) => Err(io::ErrorKind::NotFound.into()),
        }
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<String>> {
        let canonical = self.canonical(folder);
        let own = self
            .texts
            .keys()
            .filter(|path| path.parent() == Some(&canonical))
            .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()));
        let mut names: BTreeSet<String> = own.collect();
        if let Some(below) = &self.below {
            names.extend(below.list(folder).unwrap_or_default());
        }
        Ok(names.into_iter().collect())
    }

    fn canonical(&self, path: &Path) -> PathBuf {
        match &self.below {
            Some(below) => below.canonical(path),
            None => plain(path),
        }
    }
}

impl fmt::Debug for MemoryFiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MemoryFiles")
            .field("texts", &self.texts.keys())
            .finish_non_exhaustive()
    }
}

/// The path with `.` and `..` taken out, without asking the disk.
pub(crate) fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => match plain.components().next_back() {
                Some(Component::Normal(_)) => {
                    plain.pop();
                }
                Some(Component::RootDir | Component::Prefix(_)) => {}
                _ => plain.push(".."),
            },
            part => plain.push(part),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lose_their_detours() {
        for (path, expected) in [
            ("a/./b/../c", "a/c"),
            ("../a/../../b", "../../b"),
            ("/../a", "/a"),
            ("./a", "a"),
            ("a/..", ""),
        ] {
            assert_eq!(plain(Path::new(path)), Path::new(expected), "{path}");
        }
    }

    #[test]
    fn memory_lies_over_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a.wgsl"), folder.path().join("b.wgsl"));
        fs::write(&a, "disk").unwrap();
        let files = MemoryFiles::over(Arc::new(DiskFiles));
        assert_eq!(files.read(&a).unwrap(), "disk");
        let files = files
            .with(folder.path().join("x/../a.wgsl"), "memory")
            .with(&b, "new");
        assert_eq!(files.read(&a).unwrap(), "memory");
        assert_eq!(files.read(&b).unwrap(), "new");
        assert_eq!(files.list(folder.path()).unwrap(), ["a.wgsl", "b.wgsl"]);
        let gone = files.read(&folder.path().join("c.wgsl")).unwrap_err();
        assert_eq!(gone.kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn what_is_too_large_or_no_file_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.wgsl");
        fs::write(&path, vec![b' '; (MAX_FILE_BYTES + 1) as usize]).unwrap();
        let error = DiskFiles.read(&path).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidData);
        let error = DiskFiles.read(folder.path()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
    }
}
