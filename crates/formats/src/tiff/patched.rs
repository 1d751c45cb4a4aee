//! A file of which a few bytes are read as if they were others.
//!
//! The decoder of TIFF goes from one directory to the next; told that another directory is the first one, it begins
//! there. It turns pages around whose zero is white, and refuses palettes; told that zero is black, it gives the values
//! as they are stored.

use std::io::{self, Read, Seek, SeekFrom};

use crate::input::BufReadSeek;

/// What decoders read.
pub(super) type Source<'a> = Patched<Box<dyn BufReadSeek + 'a>>;

/// Reads through to the file, with bytes at some offsets replaced.
pub(super) struct Patched<R> {
    pub reader: R,
    pub at: u64,
    /// Offset and the bytes there.
    pub patches: Vec<(u64, Vec<u8>)>,
}

impl<R: Read> Read for Patched<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let got = self.reader.read(buffer)?;
        for (from, bytes) in &self.patches {
            for (offset, byte) in (*from..).zip(bytes) {
                let index = offset.checked_sub(self.at).map(|index| index as usize);
                if let Some(target) = index.and_then(|index| buffer[..got].get_mut(index)) {
                    *target = *byte;
                }
            }
        }
        self.at += got as u64;
        Ok(got)
    }
}

impl<R: Seek> Seek for Patched<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = self.reader.seek(to)?;
        Ok(self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_replaced_wherever_reading_begins() {
        for from in 0..8_u64 {
            let mut patched = Patched {
                reader: io::Cursor::new(*b"01234567"),
                at: 0,
                patches: vec![(2, b"ab".to_vec()), (7, b"z".to_vec())],
            };
            patched.seek(SeekFrom::Start(from)).unwrap();
            let mut read = Vec::new();
            patched.read_to_end(&mut read).unwrap();
            assert_eq!(read, b"01ab456z"[from as usize..]);
        }
    }
}
