//! A zip archive as a place of files: its directory, and entries that are stored or deflated.
//!
//! The directory at the end is read once, entry by entry out of what is there; what an entry says of its length is
//! held against the archive's when it is opened. Stored entries are read where they lie, single parts of them alone.
//! Deflated ones are unpacked one at a time, never past what they may become. Archives of more than 4 GiB or 65 535
//! entries have their numbers in records of 64 bits.
//! Source: PKWARE's APPNOTE 6.3.10, <https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT>.

mod entry;

use std::collections::BTreeMap;
use std::collections::btree_map::Range;
use std::fs::File;
use std::io::Read as _;
use std::ops::Bound;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use volgraph_volume::{Trouble, VolumeError};

pub(super) use entry::Entry;
use entry::{DEFLATED, STORED, entry_of, long, short, word};

use super::MARKS;
use crate::bricks::read_at;
use crate::input::Input;

/// The end of the directory without its comment, which has at most 65 535 bytes.
const END: u64 = 22;
const LONGEST_COMMENT: u64 = 65_535;

/// Where the 64-bit end is said to lie, right before the other end; and its own least length.
const LOCATOR: u64 = 20;
const END_64: u64 = 56;

/// The header before an entry's bytes, without its name.
const LOCAL: u64 = 30;

/// Most bytes of a directory: some ten million entries.
const LONGEST_DIRECTORY: u64 = 1 << 30;

/// Whether a file begins with an entry.
pub(super) fn is_zip(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04")
}

/// The name of the first entry, by the head of the archive.
pub(super) fn first_name(head: &[u8]) -> Option<&str> {
    let len = usize::from(u16::from_le_bytes(head.get(26..28)?.try_into().ok()?));
    std::str::from_utf8(head.get(30..30 + len)?).ok()
}

fn broken(cause: impl Into<String>) -> VolumeError {
    VolumeError::DataCorrupt(Trouble::new(cause, "fetch the archive again"))
}

#[derive(Debug)]
enum Bytes {
    File(File),
    Memory(Arc<[u8]>),
}

/// An archive whose directory was read.
#[derive(Debug)]
pub(super) struct Zip {
    path: PathBuf,
    bytes: Bytes,
    len: u64,
    entries: BTreeMap<String, Entry>,
}

impl Zip {
    pub fn open(input: &Input<'_>) -> Result<Self, VolumeError> {
        let bytes = if input.is_memory() {
            Bytes::Memory(input.bytes_at(0, input.len)?.into())
        } else {
            let file = File::open(&input.path);
            Bytes::File(file.map_err(|error| input.unreadable(&error))?)
        };
        let mut zip = Self {
            path: input.path.clone(),
            bytes,
            len: input.len,
            entries: BTreeMap::new(),
        };
        zip.entries = zip.directory()?;
        Ok(zip)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder that has Zarr's metadata: the archive itself, or the only one of those that lie highest in it.
    pub fn root(&self) -> Result<PathBuf, VolumeError> {
        let folders = self.entries.keys().filter_map(|name| {
            let (folder, file) = name.rsplit_once('/').unwrap_or(("", name));
            MARKS.contains(&file).then_some(folder)
        });
        let depth = |folder: &str| match folder {
            "" => 0,
            folder => 1 + folder.matches('/').count(),
        };
        let mut highest: Vec<&str> = Vec::new();
        for folder in folders {
            let best = highest.first().map_or(usize::MAX, |first| depth(first));
            if depth(folder) < best {
                highest.clear();
            }
            if depth(folder) <= best && highest.last() != Some(&folder) {
                highest.push(folder);
            }
        }
        highest.dedup();
        match highest.as_slice() {
            [one] => Ok(self.path.join(one)),
            [] => Err(VolumeError::Unsupported(Trouble::new(
                "this zip archive has no Zarr hierarchy in it",
                "unpack the archive, and give the volume that was in it",
            ))),
            several => Err(VolumeError::Unsupported(Trouble::new(
                format!(
                    "this zip archive has {} Zarr hierarchies side by side",
                    several.len()
                ),
                "unpack the archive, and give one of the folders",
            ))),
        }
    }

    pub fn entry(&self, path: &Path) -> Option<&Entry> {
        self.entries.get(&self.name(path)?)
    }

    /// Names of the folders in a folder, at most `most` and one more.
    pub fn folders(&self, path: &Path, most: usize) -> Vec<String> {
        let Some(folder) = self.name(path) else {
            return Vec::new();
        };
        let prefix = if folder.is_empty() {
            folder
        } else {
            format!("{folder}/")
        };
        let mut names: Vec<String> = Vec::new();
        let mut at = prefix.clone();
        while names.len() <= most {
            let mut behind: Range<'_, String, Entry> = self
                .entries
                .range::<str, _>((Bound::Included(at.as_str()), Bound::Unbounded));
            let Some(rest) = behind
                .next()
                .and_then(|(name, _)| name.strip_prefix(&prefix))
            else {
                break;
            };
            match rest.split_once('/') {
                Some((name, _)) => {
                    // `0` comes right behind `/`: on behind all that is in there.
                    at = format!("{prefix}{name}0");
                    if !name.is_empty() {
                        names.push(name.to_owned());
                    }
                }
                None => at = format!("{prefix}{rest}\0"),
            }
        }
        names
    }

    /// The name of the entry at a path.
    fn name(&self, path: &Path) -> Option<String> {
        let mut name = String::new();
        for part in path.strip_prefix(&self.path).ok()?.components() {
            match part {
                Component::CurDir => {}
                Component::Normal(part) => {
                    if !name.is_empty() {
                        name.push('/');
                    }
                    name.push_str(part.to_str()?);
                }
                _ => return None,
            }
        }
        Some(name)
    }

    /// Bytes of the archive.
    pub fn read(&self, at: u64, count: u64) -> Result<Vec<u8>, VolumeError> {
        let end = at.checked_add(count).filter(|&end| end <= self.len);
        let cut_off = || {
            VolumeError::DataTooShort(Trouble::new(
                format!(
                    "{count} bytes from byte {at} on are promised, the archive has {}",
                    self.len
                ),
                "the archive is cut off: fetch it again",
            ))
        };
        let (Some(end), Ok(size)) = (end, usize::try_from(count)) else {
            return Err(cut_off());
        };
        match &self.bytes {
            Bytes::Memory(bytes) => {
                let range = usize::try_from(at).ok().zip(usize::try_from(end).ok());
                let bytes = range.and_then(|(at, end)| bytes.get(at..end));
                bytes.map(<[u8]>::to_vec).ok_or_else(cut_off)
            }
            Bytes::File(file) => {
                let mut bytes = vec![0; size];
                read_at(file, &mut bytes, at).map_err(|error| {
                    VolumeError::Unreadable(Trouble::new(
                        format!("cannot be read: {error}"),
                        "check the file, its permissions and the disk",
                    ))
                })?;
                Ok(bytes)
            }
        }
    }

    /// Where the bytes of an entry begin; the archive has all of them.
    pub fn start(&self, entry: &Entry) -> Result<u64, VolumeError> {
        let unsupported = |cause: String, remedy: &str| {
            Err(VolumeError::Unsupported(Trouble::new(cause, remedy)))
        };
        if entry.encrypted {
            return unsupported(
                "the entry is encrypted".into(),
                "unpack the archive, and give the folder",
            );
        }
        if !matches!(entry.method, STORED | DEFLATED) {
            return unsupported(
                format!("entries packed by the method {} are not read", entry.method),
                "pack the archive again, stored: `zip -0 -r NEW.zarr.zip .` in the folder",
            );
        }
        if entry.method == STORED && entry.packed != entry.size {
            return Err(broken(format!(
                "a stored entry of {} bytes has {}",
                entry.size, entry.packed
            )));
        }
        let local = self.read(entry.header, LOCAL)?;
        if !is_zip(&local) {
            return Err(broken("the directory names an entry that is not there"));
        }
        let start =
            entry.header + LOCAL + u64::from(short(&local, 26)) + u64::from(short(&local, 28));
        if start
            .checked_add(entry.packed)
            .is_none_or(|end| end > self.len)
        {
            return Err(VolumeError::DataTooShort(Trouble::new(
                format!(
                    "an entry of {} bytes at byte {start}, and the archive has {}",
                    entry.packed, self.len
                ),
                "the archive is cut off: fetch it again",
            )));
        }
        Ok(start)
    }

    /// All bytes of a deflated entry; refused where they are more than `most`.
    pub fn unpacked(&self, entry: &Entry, most: u64) -> Result<Vec<u8>, VolumeError> {
        let too_large = |size: u64| {
            broken(format!(
                "the entry holds {size} bytes or more, and {most} are the most it can need"
            ))
        };
        if entry.size > most {
            return Err(too_large(entry.size));
        }
        let packed = self.read(self.start(entry)?, entry.packed)?;
        let mut bytes = Vec::new();
        let stream = flate2::read::DeflateDecoder::new(packed.as_slice());
        let read = stream
            .take(entry.size.saturating_add(1))
            .read_to_end(&mut bytes);
        read.map_err(|error| broken(format!("the deflated entry is broken: {error}")))?;
        if bytes.len() as u64 != entry.size {
            return Err(broken(format!(
                "the deflated entry does not hold {} bytes",
                entry.size
            )));
        }
        entry.check(&bytes)?;
        Ok(bytes)
    }

    fn directory(&self) -> Result<BTreeMap<String, Entry>, VolumeError> {
        let (at, size) = self.end()?;
        if size > LONGEST_DIRECTORY {
            return Err(VolumeError::TooLarge(Trouble::new(
                format!("a directory of {size} bytes; {LONGEST_DIRECTORY} are the most"),
                "unpack the archive, and give the folder",
            )));
        }
        let bytes = self.read(at, size)?;
        let mut entries = BTreeMap::new();
        let mut rest = bytes.as_slice();
        while !rest.is_empty() {
            let (name, entry, behind) =
                entry_of(rest).ok_or_else(|| broken("the directory of the archive is broken"))?;
            // Of entries of one name the last one counts.
            if let Ok(name) = std::str::from_utf8(name)
                && !name.ends_with('/')
            {
                entries.insert(name.to_owned(), entry);
            }
            rest = behind;
        }
        Ok(entries)
    }

    /// Where the directory lies, and its bytes.
    fn end(&self) -> Result<(u64, u64), VolumeError> {
        let cut_off = || {
            VolumeError::DataTooShort(Trouble::new(
                "the archive has no directory at its end",
                "the archive is cut off: fetch it again",
            ))
        };
        let tail_len = self.len.min(END + LONGEST_COMMENT);
        let tail_at = self.len - tail_len;
        let tail = self.read(tail_at, tail_len)?;
        // The last one whose comment ends with the archive.
        let ends = tail.windows(END as usize).enumerate().rev();
        let end = ends
            .filter(|(_, end)| end.starts_with(b"PK\x05\x06"))
            .find(|(at, end)| at + END as usize + usize::from(short(end, 20)) == tail.len());
        let (at, end) = end.ok_or_else(cut_off)?;
        let end_at = tail_at + at as u64;
        if end_at >= LOCATOR {
            let locator = self.read(end_at - LOCATOR, LOCATOR)?;
            if locator.starts_with(b"PK\x06\x07") {
                let end = self.read(long(&locator, 8), END_64)?;
                if !end.starts_with(b"PK\x06\x06") {
                    return Err(broken(
                        "the 64-bit end of the directory is not where it should be",
                    ));
                }
                return Ok((long(&end, 48), long(&end, 40)));
            }
        }
        Ok((word(end, 16).into(), word(end, 12).into()))
    }
}
