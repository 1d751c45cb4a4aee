//! The directory of a page as it lies in the file: what the decoder does not tell.

use tiff::tags::Tag;
use volgraph_volume::VolumeError;

use crate::input::Input;

/// A number of any width.
pub(super) fn number(bytes: &[u8], big_endian: bool) -> u64 {
    let fold = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
    if big_endian {
        bytes.iter().fold(0, fold)
    } else {
        bytes.iter().rev().fold(0, fold)
    }
}

/// A directory as it lies in the file: only what the decoder does not tell.
pub(super) struct Entries {
    pub at: u64,
    /// Bytes that it takes.
    pub size: u64,
    /// Tag, offset of the entry's value and the first two or four bytes of it as a number.
    found: Vec<(u64, u64, u64)>,
    pub next: u64,
}

impl Entries {
    pub fn read(
        input: &Input<'_>,
        at: u64,
        big_endian: bool,
        big_tiff: bool,
    ) -> Result<Self, VolumeError> {
        let (count_size, entry_size, next_size) = if big_tiff { (8, 20, 8) } else { (2, 12, 4) };
        let count = number(&input.bytes_at(at, count_size)?, big_endian);
        let first = at.saturating_add(count_size);
        let size = count.saturating_mul(entry_size);
        let bytes = input.bytes_at(first, size.saturating_add(next_size))?;
        let (entries, next) = bytes.split_at(size as usize);
        let wanted = [
            Tag::NewSubfileType,
            Tag::PhotometricInterpretation,
            Tag::ResolutionUnit,
        ];
        let wanted = wanted.map(|tag| u64::from(tag.to_u16()));
        let found = (0_u64..)
            .zip(entries.chunks_exact(entry_size as usize))
            .filter_map(|(i, entry)| {
                let tag = number(&entry[..2], big_endian);
                let value_at = if big_tiff { 12 } else { 8 };
                // Type 3 has two bytes, type 4 four.
                let size = if number(&entry[2..4], big_endian) == 3 {
                    2
                } else {
                    4
                };
                let value = number(&entry[value_at..value_at + size], big_endian);
                let offset = first + i * entry_size + value_at as u64;
                wanted.contains(&tag).then_some((tag, offset, value))
            });
        Ok(Self {
            at,
            size,
            found: found.collect(),
            next: number(next, big_endian),
        })
    }

    fn entry(&self, tag: Tag) -> Option<(u64, u64)> {
        let tag = u64::from(tag.to_u16());
        let entry = self.found.iter().find(|(found, ..)| *found == tag);
        entry.map(|&(_, offset, value)| (offset, value))
    }

    pub fn value(&self, tag: Tag) -> Option<u64> {
        self.entry(tag).map(|(_, value)| value)
    }

    pub fn offset(&self, tag: Tag) -> Option<u64> {
        self.entry(tag).map(|(offset, _)| offset)
    }
}
