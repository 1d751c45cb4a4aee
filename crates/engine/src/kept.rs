//! Small files that save time at the next start, in the folder of files that can be made again.
//!
//! A file is the digest of its content and the content. One that is cut off, changed or too long is none: what it was for
//! is made again and written over it.

use std::fs;
use std::io::{Read, Write};
use std::path::PathBuf;
use std::sync::Arc;

use volgraph_gpu::Keep;

use crate::truth::prune;

/// Most bytes of all files; those that were written first go first.
const MAX_KEPT_BYTES: u64 = 64 << 20;

/// Files are at most this long.
const MAX_BYTES: u64 = 16 << 20;

/// Bytes of a digest.
const DIGEST: usize = 32;

/// Files in a folder.
pub(crate) struct KeptFiles {
    folder: PathBuf,
}

impl KeptFiles {
    /// In the folder for files that can be made again; nowhere where there is none.
    pub fn below(cache: Option<&PathBuf>) -> Option<Arc<dyn Keep>> {
        let folder = cache?.join("device");
        Some(Arc::new(Self { folder }))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name).with_extension("kept")
    }

    fn try_write(&self, name: &str, bytes: &[u8]) -> std::io::Result<()> {
        fs::create_dir_all(&self.folder)?;
        let mut part = tempfile::NamedTempFile::new_in(&self.folder)?;
        part.write_all(blake3::hash(bytes).as_bytes())?;
        part.write_all(bytes)?;
        part.persist(self.file(name))?;
        prune(&self.folder, "kept", MAX_KEPT_BYTES)
    }
}

impl Keep for KeptFiles {
    fn read(&self, name: &str) -> Option<Vec<u8>> {
        let file = fs::File::open(self.file(name)).ok()?;
        let mut bytes = Vec::new();
        let most = MAX_BYTES + DIGEST as u64;
        file.take(most + 1).read_to_end(&mut bytes).ok()?;
        let (digest, content) = bytes.split_at_checked(DIGEST)?;
        let is_whole = bytes.len() as u64 <= most && blake3::hash(content).as_bytes() == digest;
        is_whole.then(|| content.to_vec())
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        if bytes.len() as u64 <= MAX_BYTES {
            // Without it the next start takes longer, and that is all.
            let _ = self.try_write(name, bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_what_was_written_is_nothing_and_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let kept = KeptFiles {
            folder: folder.path().join("device"),
        };
        assert_eq!(kept.read("a"), None);
        kept.write("a", b"fast");
        kept.write("b", b"");
        assert_eq!(kept.read("a").unwrap(), b"fast");
        assert_eq!(kept.read("b").unwrap(), b"");
        let whole = fs::read(kept.file("a")).unwrap();
        let mut changed = whole.clone();
        *changed.last_mut().unwrap() ^= 1;
        for wrong in [&whole[..whole.len() - 1], &whole[..31], &[], &changed] {
            fs::write(kept.file("a"), wrong).unwrap();
            assert_eq!(kept.read("a"), None, "{wrong:?}");
        }
        kept.write("a", b"slow");
        assert_eq!(kept.read("a").unwrap(), b"slow");
        // Longer than anything is kept.
        let long = vec![0; (MAX_BYTES + 1) as usize];
        kept.write("a", &long);
        assert_eq!(kept.read("a").unwrap(), b"slow");
        let mut file = blake3::hash(&long).as_bytes().to_vec();
        file.extend(long);
        fs::write(kept.file("a"), file).unwrap();
        assert_eq!(kept.read("a"), None);
        // A folder that is none keeps nothing, and nobody minds.
        let none = KeptFiles {
            folder: kept.file("b"),
        };
        none.write("a", b"fast");
        assert_eq!(none.read("a"), None);
    }
}
