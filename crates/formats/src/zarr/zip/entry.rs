//! An entry of an archive's directory, out of its bytes; all numbers are little-endian.

use volgraph_volume::VolumeError;

use super::broken;

/// An entry without its name.
const HEADER: usize = 46;

/// What a deflated byte can become.
const MOST_RATIO: u64 = 1040;

/// How files are packed.
pub(super) const STORED: u16 = 0;
pub(super) const DEFLATED: u16 = 8;

/// An entry of the directory, as it says itself.
#[derive(Clone, Copy, Debug)]
pub(in crate::zarr) struct Entry {
    pub(super) header: u64,
    pub(super) packed: u64,
    pub(super) size: u64,
    pub(super) method: u16,
    pub(super) encrypted: bool,
    checksum: u32,
}

impl Entry {
    pub fn is_deflated(&self) -> bool {
        self.method == DEFLATED
    }

    pub fn size(&self) -> u64 {
        self.size
    }

    /// Most bytes that can be there, whatever the entry says.
    pub fn most_len(&self) -> u64 {
        match self.method {
            STORED => self.packed.min(self.size),
            _ => self.size.min(self.packed.saturating_mul(MOST_RATIO)),
        }
    }

    /// Refuses other bytes than those that were packed.
    pub fn check(&self, bytes: &[u8]) -> Result<(), VolumeError> {
        let mut sum = flate2::Crc::new();
        sum.update(bytes);
        if sum.sum() != self.checksum {
            return Err(broken("the checksum of the entry is another"));
        }
        Ok(())
    }
}

pub(super) fn short(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

pub(super) fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from(short(bytes, at)) | u32::from(short(bytes, at + 2)) << 16
}

pub(super) fn long(bytes: &[u8], at: usize) -> u64 {
    u64::from(word(bytes, at)) | u64::from(word(bytes, at + 4)) << 32
}

/// The first entry of a directory: its name, what it says, and what is behind it.
pub(super) fn entry_of(bytes: &[u8]) -> Option<(&[u8], Entry, &[u8])> {
    let (head, rest) = bytes.split_at_checked(HEADER)?;
    if !head.starts_with(b"PK\x01\x02") {
        return None;
    }
    let (name, rest) = rest.split_at_checked(short(head, 28).into())?;
    let (extra, rest) = rest.split_at_checked(short(head, 30).into())?;
    let (_comment, rest) = rest.split_at_checked(short(head, 32).into())?;
    let mut entry = Entry {
        header: word(head, 42).into(),
        packed: word(head, 20).into(),
        size: word(head, 24).into(),
        method: short(head, 10),
        encrypted: short(head, 8) & 1 != 0,
        checksum: word(head, 16),
    };
    let mut wide = wide_numbers(extra);
    for number in [&mut entry.size, &mut entry.packed, &mut entry.header] {
        if *number == u64::from(u32::MAX) {
            let (value, behind) = wide.split_at_checked(8)?;
            *number = long(value, 0);
            wide = behind;
        }
    }
    Some((name, entry, rest))
}

/// The 64-bit numbers among the extra fields, which have a tag and a length of 16 bits each.
fn wide_numbers(mut extra: &[u8]) -> &[u8] {
    while let Some((field, rest)) = extra.split_at_checked(4) {
        let Some((data, behind)) = rest.split_at_checked(short(field, 2).into()) else {
            break;
        };
        if short(field, 0) == 1 {
            return data;
        }
        extra = behind;
    }
    &[]
}
