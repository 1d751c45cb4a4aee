//! A folder for the files of one input, in memory where the system has such a place.

use std::path::{Component, Path};

use tempfile::TempDir;

/// Most files of one input.
const MOST_FILES: usize = 24;

/// Gone when it is dropped.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        let shared_memory = Path::new("/dev/shm");
        let place = if shared_memory.is_dir() {
            shared_memory.to_path_buf()
        } else {
            std::env::temp_dir()
        };
        let folder = tempfile::Builder::new()
            .prefix("volgraph-fuzz-")
            .tempdir_in(place)
            .expect("a temporary folder");
        Self(folder)
    }

    /// The files that an input has behind lines `//// PATH`; what stands before the first one is left out.
    pub fn of(data: &[u8]) -> Self {
        const MARK: &[u8] = b"//// ";
        let folder = Self::new();
        let at = |from: usize| {
            let found = data[from..]
                .windows(MARK.len())
                .position(|part| part == MARK);
            found.map(|position| from + position)
        };
        let mut next = at(0);
        for _ in 0..MOST_FILES {
            let Some(start) = next.map(|mark| mark + MARK.len()) else {
                break;
            };
            next = at(start);
            let piece = &data[start..next.unwrap_or(data.len())];
            let end = piece.iter().position(|byte| *byte == b'\n');
            let (name, body) = piece.split_at(end.unwrap_or(piece.len()));
            if let Ok(name) = std::str::from_utf8(name) {
                folder.write(name, body.get(1..).unwrap_or_default());
            }
        }
        folder
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file inside; one with a name that leads elsewhere, or that the system does not take, is left out.
    pub fn write(&self, name: &str, bytes: &[u8]) {
        let inside = |part: Component<'_>| matches!(part, Component::Normal(_));
        if name.is_empty() || name.contains('\0') || !Path::new(name).components().all(inside) {
            return;
        }
        let path = self.path().join(name);
        let parent = path.parent().unwrap_or(&path);
        if std::fs::create_dir_all(parent).is_ok() {
            let _ = std::fs::write(path, bytes);
        }
    }
}
