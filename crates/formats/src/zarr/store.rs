//! Where the files of a hierarchy lie: in a folder, or in a zip archive, whose entries are named as if it were one
//! (`a.zarr.zip/0/zarr.json`).

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use volgraph_volume::{Trouble, VolumeError};

use super::zip::{Entry, Zip};
use crate::bricks::read_at;

/// A place of files; a clone is the same place.
#[derive(Clone, Debug)]
pub(super) enum Store {
    Folder,
    Zip(Arc<Zip>),
}

impl Store {
    /// A file's bytes, of which some are read; `None` where there is none. One that is packed is unpacked here, and
    /// refused where that would be more than `most` bytes.
    pub fn open(&self, path: &Path, most: u64) -> Result<Option<Open>, VolumeError> {
        match self {
            Self::Folder => Open::file(path).map_err(|error| unreadable(path, &error)),
            Self::Zip(zip) => {
                let Some(&entry) = zip.entry(path) else {
                    return Ok(None);
                };
                let open = if entry.is_deflated() {
                    zip.unpacked(&entry, most).map(Open::Bytes)
                } else {
                    zip.start(&entry).map(|start| Open::Stored {
                        zip: Arc::clone(zip),
                        entry,
                        start,
                    })
                };
                open.map(Some).map_err(|error| error.in_file(path))
            }
        }
    }

    pub fn has(&self, path: &Path) -> bool {
        match self {
            Self::Folder => path.is_file(),
            Self::Zip(zip) => zip.entry(path).is_some(),
        }
    }

    /// Most bytes that a file can have, by what lies on the disk; 0 where there is none.
    pub fn len(&self, path: &Path) -> u64 {
        match self {
            Self::Folder => std::fs::metadata(path).map_or(0, |file| file.len()),
            Self::Zip(zip) => zip.entry(path).map_or(0, Entry::most_len),
        }
    }

    /// Names of the folders in a folder, at most `most` and one more.
    pub fn folders(&self, path: &Path, most: usize) -> Result<Vec<String>, VolumeError> {
        match self {
            Self::Zip(zip) => Ok(zip.folders(path, most)),
            Self::Folder => {
                let failed = |error: io::Error| {
                    VolumeError::Unreadable(Trouble::new(
                        format!("cannot be listed: {error}"),
                        "check its permissions",
                    ))
                    .in_file(path)
                };
                let mut names = Vec::new();
                for entry in std::fs::read_dir(path).map_err(failed)? {
                    let entry = entry.map_err(failed)?;
                    if entry.path().is_dir()
                        && let Some(name) = entry.file_name().to_str()
                    {
                        names.push(name.to_owned());
                    }
                    if names.len() > most {
                        break;
                    }
                }
                Ok(names)
            }
        }
    }

    /// The file on the disk that has the one at a path.
    pub fn file_of(&self, path: &Path) -> PathBuf {
        match self {
            Self::Folder => path.to_path_buf(),
            Self::Zip(zip) => zip.path().to_path_buf(),
        }
    }
}

/// A file that is there.
pub(super) enum Open {
    File {
        file: File,
        len: u64,
    },
    /// Bytes of an archive as they are.
    Stored {
        zip: Arc<Zip>,
        entry: Entry,
        start: u64,
    },
    Bytes(Vec<u8>),
}

impl Open {
    /// Bytes of memory that it holds.
    pub fn bytes_in_memory(&self) -> u64 {
        match self {
            Self::Bytes(bytes) => bytes.len() as u64,
            Self::File { .. } | Self::Stored { .. } => 0,
        }
    }

    fn file(path: &Path) -> io::Result<Option<Self>> {
        let file = match File::open(path) {
            Ok(file) => file,
            Err(error)
                if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) =>
            {
                return Ok(None);
            }
            Err(error) => return Err(error),
        };
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(io::Error::other("is no regular file"));
        }
        let len = metadata.len();
        Ok(Some(Self::File { file, len }))
    }

    pub fn len(&self) -> u64 {
        match self {
            Self::File { len, .. } => *len,
            Self::Stored { entry, .. } => entry.size(),
            Self::Bytes(bytes) => bytes.len() as u64,
        }
    }

    /// Bytes that are known to be in the file.
    pub fn read(&self, from: u64, count: u64) -> Result<Vec<u8>, VolumeError> {
        let too_short = |got: u64| {
            VolumeError::DataTooShort(Trouble::new(
                format!("has {got} of {count} bytes"),
                "fetch the chunk again",
            ))
        };
        match self {
            Self::File { file, len } => {
                if from.checked_add(count).is_none_or(|end| end > *len) {
                    return Err(too_short(len.saturating_sub(from)));
                }
                // Several chunks of a shard are read from one file at once: it must not be one place that moves.
                let mut bytes = vec![0; usize::try_from(count).map_err(|_| too_short(0))?];
                match read_at(file, &mut bytes, from) {
                    Ok(()) => Ok(bytes),
                    Err(error) if error.kind() == ErrorKind::UnexpectedEof => Err(too_short(0)),
                    Err(error) => Err(unreadable(Path::new(""), &error)),
                }
            }
            Self::Stored { zip, entry, start } => {
                if from.checked_add(count).is_none_or(|end| end > entry.size()) {
                    return Err(too_short(entry.size().saturating_sub(from)));
                }
                let bytes = zip.read(start + from, count)?;
                if count == entry.size() {
                    entry.check(&bytes)?;
                }
                Ok(bytes)
            }
            Self::Bytes(all) => {
                let range = usize::try_from(from)
                    .ok()
                    .zip(usize::try_from(from.saturating_add(count)).ok());
                let bytes = range.and_then(|(from, end)| all.get(from..end));
                bytes
                    .map(<[u8]>::to_vec)
                    .ok_or_else(|| too_short(self.len().saturating_sub(from)))
            }
        }
    }

    /// All bytes.
    pub fn read_all(self) -> Result<Vec<u8>, VolumeError> {
        match self {
            Self::Bytes(bytes) => Ok(bytes),
            other => other.read(0, other.len()),
        }
    }
}

fn unreadable(path: &Path, error: &io::Error) -> VolumeError {
    VolumeError::Unreadable(Trouble::new(
        format!("cannot be read: {error}"),
        "check the file, its permissions and the disk",
    ))
    .in_file(path)
}
