//! Whole files only: what is written appears at once, what is read is a plain file with a known beginning.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::{Format, PictureError};

const PNG_MAGIC: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Decoded bytes that any file may ask for, and how many for each of its own bytes beyond that. Deflate reaches
/// at most 1032 and the other codecs come near it, so a file that asks for more is cut short or a trap.
const FREE_BYTES: u64 = 64 << 20;
const MAX_RATIO: u64 = 2048;

/// The format that the extension names.
pub(crate) fn format_of(path: &Path) -> Result<Format, PictureError> {
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("png") {
        Ok(Format::Png)
    } else if extension.eq_ignore_ascii_case("exr") {
        Ok(Format::Exr)
    } else {
        Err(PictureError::Extension {
            path: path.to_path_buf(),
        })
    }
}

/// Opens a plain file that starts as a PNG or an EXR does; also gives its length.
pub(crate) fn open(path: &Path) -> Result<(Format, BufReader<File>, u64), PictureError> {
    let failed = |source| PictureError::Io {
        path: path.to_path_buf(),
        source,
    };
    // A pipe or a device could block for ever, so it is not even opened.
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(PictureError::NotAPicture {
            path: path.to_path_buf(),
        });
    }
    let mut reader = BufReader::new(File::open(path).map_err(failed)?);
    let mut head = Vec::with_capacity(PNG_MAGIC.len());
    reader
        .by_ref()
        .take(PNG_MAGIC.len() as u64)
        .read_to_end(&mut head)
        .map_err(failed)?;
    reader.seek(SeekFrom::Start(0)).map_err(failed)?;
    Ok((format_of_content(path, &head)?, reader, metadata.len()))
}

/// The format that a file's first bytes tell.
pub(crate) fn format_of_content(path: &Path, head: &[u8]) -> Result<Format, PictureError> {
    if head.starts_with(&PNG_MAGIC) {
        Ok(Format::Png)
    } else if head.starts_with(&EXR_MAGIC) {
        Ok(Format::Exr)
    } else {
        Err(PictureError::NotAPicture {
            path: path.to_path_buf(),
        })
    }
}

/// Refuses a header that asks for far more bytes than its file can hold.
pub(crate) fn check_ratio(decoded_bytes: u64, file_len: u64) -> Result<(), String> {
    if decoded_bytes <= FREE_BYTES.max(file_len.saturating_mul(MAX_RATIO)) {
        Ok(())
    } else {
        Err(format!(
            "its header asks for {decoded_bytes} bytes, which a file of {file_len} bytes cannot hold"
        ))
    }
}

/// Files under their temporary names, until they are whole.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is half written, and lets nothing more be begun: for a program that is about to end.
pub fn abandon_unfinished() {
    let unfinished = unfinished();
    for file in &*unfinished {
        // It may have become whole just now.
        let _ = fs::remove_file(file);
    }
    std::mem::forget(unfinished);
}

/// A file under another name in the same folder, which takes its own when it is whole and goes when it is dropped.
pub(crate) struct Unfinished {
    path: PathBuf,
    temporary: PathBuf,
}

impl Unfinished {
    /// Begins it.
    pub(crate) fn create(path: &Path) -> io::Result<(Self, File)> {
        let (temporary, file) = create_beside(path)?;
        let path = path.to_path_buf();
        Ok((Self { path, temporary }, file))
    }

    /// Gives it its name; `is_synced` waits for the disk before.
    pub(crate) fn finish(self, file: &File, is_synced: bool) -> io::Result<()> {
        if is_synced {
            file.sync_all()?;
        }
        fs::rename(&self.temporary, &self.path)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        // After the renaming there is none. An error before is the one to tell; a leftover that cannot be removed either
        // has the same cause.
        let _ = fs::remove_file(&self.temporary);
        unfinished().remove(&self.temporary);
    }
}

/// Writes under another name in the same folder, then renames; `is_synced` waits for the disk before.
pub(crate) fn write_whole(path: &Path, bytes: &[u8], is_synced: bool) -> io::Result<()> {
    let (unfinished, mut file) = Unfinished::create(path)?;
    file.write_all(bytes)?;
    unfinished.finish(&file, is_synced)
}

fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().unwrap_or_default();
    loop {
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        let count = COUNTER.fetch_add(1, Ordering::Relaxed);
        hidden.push(format!(".{}-{count}.part", std::process::id()));
        let temporary = path.with_file_name(hidden);
        let mut unfinished = unfinished();
        match File::create_new(&temporary) {
            Ok(file) => {
                unfinished.insert(temporary.clone());
                return Ok((temporary, file));
            }
            // Left by a process that died and had our number; the counter moves on.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_that_asks_for_too_much_is_refused() {
        assert!(check_ratio(FREE_BYTES, 10).is_ok());
        assert!(check_ratio(FREE_BYTES + 1, 10).is_err());
        assert!(check_ratio(4 << 30, 2 << 20).is_ok());
        assert!(check_ratio(u64::MAX, u64::MAX / 4096).is_err());
    }
}
