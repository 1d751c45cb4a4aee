//! The data in one file: where it begins, what is passed over, how it is written down.

use std::io::{self, BufRead, ErrorKind, Read};

use volgraph_volume::{Trouble, VolumeError};

use crate::input::Input;

/// How voxels are written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Bytes as they are.
    Raw,
    /// A gzip stream.
    Gzip,
    /// A zlib stream.
    Zlib,
    /// A bzip2 stream.
    Bzip2,
    /// Two hexadecimal digits per byte; white space does not matter.
    Hex,
    /// Numbers as text.
    Text,
}

/// The data in one file.
pub(crate) struct Piece<'a> {
    pub input: Input<'a>,
    /// Where the data can begin: behind an attached header, or 0.
    pub start: u64,
    /// Lines to pass over first, before decoding.
    pub line_skip: u64,
    /// Bytes to pass over then, after decoding; `-1 - n` means that the data is followed by `n` bytes at the end.
    pub byte_skip: i64,
    pub encoding: Encoding,
    /// Whether a line end may stand behind plain data: some writers of headers with data leave one.
    pub line_end: bool,
    /// Bytes of the encoded stream, where the header tells; what follows them is somebody else's.
    pub encoded_len: Option<u64>,
}

impl<'a> Piece<'a> {
    pub fn is_binary(&self) -> bool {
        self.encoding != Encoding::Text
    }

    /// The input behind the skipped lines, and how far into the file that is.
    pub fn open(&self) -> Result<(Box<dyn BufRead + 'a>, u64), VolumeError> {
        let mut reader = self.input.open(self.start)?;
        let mut at = self.start;
        for _ in 0..self.line_skip {
            let passed = skip_line(&mut reader).map_err(|error| self.input.unreadable(&error))?;
            at += passed;
            if passed == 0 {
                return Err(VolumeError::DataTooShort(Trouble::new(
                    format!(
                        "the header skips {} lines, and the file has fewer",
                        self.line_skip
                    ),
                    "correct the line skip",
                )));
            }
        }
        Ok((reader, at))
    }
}

fn skip_line(reader: &mut dyn BufRead) -> io::Result<u64> {
    let mut passed = 0;
    loop {
        let buffer = reader.fill_buf()?;
        let end = buffer.iter().position(|&byte| byte == b'\n');
        let used = end.map_or(buffer.len(), |at| at + 1);
        reader.consume(used);
        passed += used as u64;
        if end.is_some() || used == 0 {
            return Ok(passed);
        }
    }
}

/// Reads until the block is full or the stream ends.
pub(crate) fn read_block(reader: &mut impl Read, block: &mut [u8]) -> io::Result<usize> {
    let mut done = 0;
    while done < block.len() {
        match reader.read(&mut block[done..]) {
            Ok(0) => break,
            Ok(got) => done += got,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(done)
}
