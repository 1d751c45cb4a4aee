//! What is remembered of a file: the bytes' digest, or, where reading costs too much, what the file system says.
//!
//! A [`Stamp`] is what a caller keeps. A [`Look`] is the same and more, for our own use: it includes the time of
//! the last change of the file's status, which a program cannot set, and thus tells whether reading is worth it.

use std::fs::{self, Metadata};
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// A file modified this shortly before a stamp may be modified again without a new time: file systems' clocks
/// are coarse, FAT's by two seconds. git calls such a file racily clean.
const RACY: Duration = Duration::from_secs(2);

/// What was used of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seen {
    /// Nothing could be read: there was no file, or it was not readable.
    Absent,
    /// The BLAKE3 digest of the bytes that were used.
    Digest([u8; 32]),
    /// For files too large to read again: the stamp, taken before they were read.
    Stamp(Stamp),
    /// It was read while it may have been written, and nothing tells what was read: whatever is there now is told.
    Unsure,
}

impl Seen {
    /// What was used of a file whose bytes these are.
    pub fn bytes(bytes: &[u8]) -> Self {
        Self::Digest(*blake3::hash(bytes).as_bytes())
    }
}

/// What the file system says of a file: length in bytes, time of modification, and on Unix device and inode.
///
/// Two stamps are equal when these are; when they were taken does not count.
#[derive(Clone, Debug)]
pub struct Stamp {
    traits: Traits,
    taken: SystemTime,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Traits {
    len: u64,
    modified: Option<SystemTime>,
    identity: Option<Identity>,
}

/// Device and inode, where there are such.
pub(crate) type Identity = (u64, u64);

impl Stamp {
    /// The stamp of the file at `path`; links are followed.
    ///
    /// # Errors
    ///
    /// What the file system says where it tells nothing of the file.
    pub fn of(path: &Path) -> io::Result<Self> {
        // The clock is read first: what changes after it counts as young.
        let taken = SystemTime::now();
        fs::metadata(path).map(|metadata| Self::new(&metadata, taken))
    }

    fn new(metadata: &Metadata, taken: SystemTime) -> Self {
        Self {
            traits: Traits {
                len: metadata.len(),
                modified: metadata.modified().ok(),
                identity: identity(metadata),
            },
            taken,
        }
    }

    /// The length in bytes.
    pub fn len(&self) -> u64 {
        self.traits.len
    }

    /// Whether the file has no bytes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// When the file was modified last, where the file system tells.
    pub fn modified(&self) -> Option<SystemTime> {
        self.traits.modified
    }

    /// Whether the file may be modified after this stamp without a difference in the stamp. A time in the future
    /// comes from another machine's clock and proves nothing.
    pub(crate) fn is_racy(&self) -> bool {
        self.traits.modified.is_none_or(|modified| {
            self.taken
                .duration_since(modified)
                .map_or(true, |age| age < RACY)
        })
    }
}

impl PartialEq for Stamp {
    fn eq(&self, other: &Self) -> bool {
        self.traits == other.traits
    }
}

impl Eq for Stamp {}

/// A stamp with the kind of the file and the time of its last change of status.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Look {
    pub(crate) stamp: Stamp,
    pub(crate) is_file: bool,
    changed: Option<(i64, i64)>,
}

impl Look {
    /// `None` where the file system tells nothing.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let taken = SystemTime::now();
        let metadata = fs::metadata(path).ok()?;
        Some(Self::new(&metadata, taken))
    }

    pub(crate) fn new(metadata: &Metadata, taken: SystemTime) -> Self {
        Self {
            stamp: Stamp::new(metadata, taken),
            is_file: metadata.is_file(),
            changed: changed(metadata),
        }
    }
}

/// Device and inode of what lies at `path`.
pub(crate) fn identity_of(path: &Path) -> Option<Identity> {
    fs::metadata(path).ok().as_ref().and_then(identity)
}

#[cfg(unix)]
pub(crate) fn identity(metadata: &Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
pub(crate) fn identity(_: &Metadata) -> Option<Identity> {
    None
}

#[cfg(unix)]
fn changed(metadata: &Metadata) -> Option<(i64, i64)> {
    use std::os::unix::fs::MetadataExt;
    Some((metadata.ctime(), metadata.ctime_nsec()))
}

#[cfg(not(unix))]
fn changed(_: &Metadata) -> Option<(i64, i64)> {
    None
}
