//! Where bytes come from: a regular file, or a slice of memory with a name.
//!
//! A reader asks for the head, then opens the input at an offset. Everything else (folders, pipes, devices,
//! missing files) is refused here, before anything could block or be endless.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use volgraph_volume::{Trouble, VolumeError};

/// A reader that can jump.
pub(crate) trait BufReadSeek: BufRead + Seek {}

impl<T: BufRead + Seek> BufReadSeek for T {}

#[derive(Clone, Debug)]
pub(crate) struct Input<'a> {
    pub path: PathBuf,
    pub len: u64,
    bytes: Option<&'a [u8]>,
}

impl<'a> Input<'a> {
    /// The file that the user named.
    pub fn file(path: &Path) -> Result<Self, VolumeError> {
        Self::regular(path).map_err(|cause| {
            let remedy = "give the path of a volume file that can be read";
            VolumeError::Unreadable(Trouble::new(cause, remedy)).in_file(path)
        })
    }

    pub fn memory(name: &str, bytes: &'a [u8]) -> Self {
        Self {
            path: name.into(),
            len: bytes.len() as u64,
            bytes: Some(bytes),
        }
    }

    /// Whether there are only bytes in memory, with no files beside them.
    pub fn is_memory(&self) -> bool {
        self.bytes.is_some()
    }

    /// A data file that this header names, relative to the header's folder.
    pub fn data_file(&self, name: &str) -> Result<Self, VolumeError> {
        let header = self.path.display();
        let refuse = |cause: String, remedy: String| {
            VolumeError::DataFile(Trouble::new(cause, remedy)).in_file(&self.path)
        };
        if self.bytes.is_some() {
            return Err(refuse(
                format!(
                    "the header names the data file {name:?}, and only bytes in memory are at hand"
                ),
                "load the header from its file, or attach the data to it".into(),
            ));
        }
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        let input = Self::regular(&path).map_err(|cause| {
            VolumeError::DataFile(Trouble::new(
                format!("{cause}; {header} names it as its data file"),
                "put the data file where the header says, or correct the header",
            ))
            .in_file(&path)
        })?;
        let same = match (path.canonicalize(), self.path.canonicalize()) {
            (Ok(data), Ok(header)) => data == header,
            _ => false,
        };
        if same {
            return Err(refuse(
                format!("the header names itself, {name:?}, as its data file"),
                "name the file that holds the voxels, or attach the data behind the header".into(),
            ));
        }
        Ok(input)
    }

    fn regular(path: &Path) -> Result<Self, String> {
        let metadata =
            std::fs::metadata(path).map_err(|error| format!("cannot be read: {error}"))?;
        if metadata.is_dir() {
            return Err("is a folder, not a file".into());
        }
        if !metadata.is_file() {
            return Err("is no regular file".into());
        }
        Ok(Self {
            path: path.to_path_buf(),
            len: metadata.len(),
            bytes: None,
        })
    }

    /// The bytes from `offset` on.
    pub fn open(&self, offset: u64) -> Result<Box<dyn BufRead + 'a>, VolumeError> {
        if let Some(bytes) = self.bytes {
            let start = usize::try_from(offset)
                .unwrap_or(usize::MAX)
                .min(bytes.len());
            return Ok(Box::new(&bytes[start..]));
        }
        let open = || -> io::Result<File> {
            let mut file = File::open(&self.path)?;
            file.seek(SeekFrom::Start(offset))?;
            Ok(file)
        };
        match open() {
            Ok(file) => Ok(Box::new(BufReader::with_capacity(1 << 16, file))),
            Err(error) => Err(self.unreadable(&error)),
        }
    }

    /// All bytes, for parsers that jump about.
    pub fn open_seek(&self) -> Result<Box<dyn BufReadSeek + 'a>, VolumeError> {
        if let Some(bytes) = self.bytes {
            return Ok(Box::new(io::Cursor::new(bytes)));
        }
        match File::open(&self.path) {
            Ok(file) => Ok(Box::new(BufReader::with_capacity(1 << 14, file))),
            Err(error) => Err(self.unreadable(&error)),
        }
    }

    /// `len` bytes from `offset` on, which are held against the file's length before anything is allocated.
    pub fn bytes_at(&self, offset: u64, len: u64) -> Result<Vec<u8>, VolumeError> {
        let end = offset.checked_add(len).filter(|&end| end <= self.len);
        let (Some(end), Ok(size)) = (end, usize::try_from(len)) else {
            return Err(VolumeError::DataTooShort(Trouble::new(
                format!(
                    "{len} bytes from byte {offset} on are promised, the file has {}",
                    self.len
                ),
                "the file is cut off: fetch it again",
            ))
            .in_file(&self.path));
        };
        let mut bytes = vec![0; size];
        let read = self.open(end - len)?.read_exact(&mut bytes);
        read.map_err(|error| self.unreadable(&error))?;
        Ok(bytes)
    }

    /// At most the first `limit` bytes.
    pub fn head(&self, limit: u64) -> Result<Vec<u8>, VolumeError> {
        let mut head = Vec::new();
        self.open(0)?
            .take(limit)
            .read_to_end(&mut head)
            .map_err(|error| self.unreadable(&error))?;
        Ok(head)
    }

    pub fn unreadable(&self, error: &io::Error) -> VolumeError {
        VolumeError::Unreadable(Trouble::new(
            format!("cannot be read: {error}"),
            "check the file, its permissions and the disk",
        ))
        .in_file(&self.path)
    }
}

/// A file's name without folder and endings: `a/b.c.nrrd` is `b`.
pub(crate) fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.split('.')
        .find(|part| !part.is_empty())
        .unwrap_or("volume")
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stem_has_no_endings() {
        assert_eq!(stem(Path::new("a/b.c.nrrd")), "b");
        assert_eq!(stem(Path::new("a/.hidden.mha")), "hidden");
        assert_eq!(stem(Path::new("/")), "volume");
    }
}
