//! The bytes of an array: lengths before them, base64 around them, compressed blocks.
//!
//! Plain bytes have their length before them, in one base64 text. Compressed ones have the number of blocks, the
//! size of each and of the last one, and the compressed sizes, in a base64 text of their own. What the array must have
//! is known from the extent, so all lengths are held against it, and against the file's own length, before anything
//! is allocated.

use std::io::{self, BufRead, ErrorKind, Read};

use base64::engine::Engine as _;
use base64::read::DecoderReader;
use flate2::bufread::ZlibDecoder;
use lzma_rust2::XzReader;
use volgraph_volume::{Trouble, VolumeError};

use super::header::{Coding, Compressor, Place};
use super::letters::{BASE64, Letters, letters};
use crate::input::Input;

/// An LZ4 block becomes at most so many times longer.
const LZ4_RATIO: u64 = 255;

/// Most memory of a decoder for LZMA: the dictionary of the highest level has 64 MiB.
const LZMA_KIB: u32 = 66 << 10;

/// The decoded bytes of an array that must have `need` of them; the stream ends behind them, or breaks.
pub(super) fn open<'a>(
    input: &Input<'a>,
    coding: &Coding,
    place: &Place,
    need: u64,
) -> Result<Box<dyn Read + 'a>, VolumeError> {
    let (from, len, base64) = match *place {
        Place::Text { from, len } | Place::Inline { from, len } => (from, len, true),
        Place::Appended { offset } => {
            let (start, base64) = coding.appended.ok_or_else(|| {
                VolumeError::MissingField(Trouble::new(
                    "the array is appended, and the file has no appended data",
                    "the file is cut off: fetch it again",
                ))
            })?;
            let from = start.saturating_add(offset);
            if from >= input.len {
                return Err(cut_off(format!(
                    "the array begins at byte {from} of a file of {}",
                    input.len
                )));
            }
            (from, input.len - from, base64)
        }
    };
    let mut source = Source {
        reader: Box::new(input.open(from)?.take(len)),
        base64,
        rest: if base64 { len / 4 * 3 + 3 } else { len },
        word: if coding.wide { 8 } else { 4 },
        big_endian: coding.big_endian,
    };
    if coding.compressor == Compressor::None {
        return source.plain(need).map_err(|error| error.told(input));
    }
    let sizes = source.sizes(need).map_err(|error| error.told(input))?;
    let packed = sizes.packed;
    Ok(Box::new(Blocks {
        stream: source.stream(packed),
        compressor: coding.compressor,
        sizes,
        next: 0,
        packed: Vec::new(),
        block: Vec::new(),
        at: 0,
    }))
}

fn cut_off(cause: String) -> VolumeError {
    VolumeError::DataTooShort(Trouble::new(
        cause,
        "the file is cut off, or its lengths are wrong: fetch it again",
    ))
}

/// What is wrong with the lengths before the bytes.
enum Wrong {
    Io(io::Error),
    Lengths(VolumeError),
}

impl From<io::Error> for Wrong {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Wrong {
    fn told(self, input: &Input<'_>) -> VolumeError {
        match self {
            Self::Lengths(error) => error,
            Self::Io(error) => stream_error(&error, input),
        }
    }
}

/// What a broken stream says to the user.
pub(super) fn stream_error(error: &io::Error, input: &Input<'_>) -> VolumeError {
    match error.kind() {
        ErrorKind::UnexpectedEof => cut_off("the bytes of the array end too early".to_owned()),
        ErrorKind::InvalidData | ErrorKind::InvalidInput => VolumeError::DataCorrupt(Trouble::new(
            format!(
                "the bytes of the array cannot be decoded: {}",
                sentence(error)
            ),
            "fetch the file again",
        )),
        _ => input.unreadable(error),
    }
}

/// What another crate says, as a part of a sentence.
pub(super) fn sentence(error: &dyn std::fmt::Display) -> String {
    error.to_string().trim_end_matches('.').to_owned()
}

fn differs(what: &str, have: u64, need: u64) -> Wrong {
    let cause = format!("the array has {have} bytes{what}; its extent needs {need}");
    Wrong::Lengths(if have < need {
        cut_off(cause)
    } else {
        VolumeError::DataTooLong(Trouble::new(
            cause,
            "the extent, the type or the number of components is wrong",
        ))
    })
}

/// The bytes of the file from the array on.
struct Source<'a> {
    reader: Box<dyn BufRead + 'a>,
    base64: bool,
    /// No more bytes than these can come.
    rest: u64,
    word: usize,
    big_endian: bool,
}

impl<'a> Source<'a> {
    /// A stream of so many bytes.
    fn stream(self, len: u64) -> Box<dyn Read + 'a> {
        if self.base64 {
            let letters = Letters {
                reader: self.reader,
                left: letters(len),
            };
            Box::new(DecoderReader::new(letters, &BASE64).take(len))
        } else {
            Box::new(self.reader.take(len))
        }
    }

    /// Bytes behind their length.
    fn plain(self, need: u64) -> Result<Box<dyn Read + 'a>, Wrong> {
        let (word, big_endian, rest) = (self.word, self.big_endian, self.rest);
        let mut stream = self.stream(need.saturating_add(word as u64));
        let mut length = [0; 8];
        stream.read_exact(&mut length[..word])?;
        let have = number(&length[..word], big_endian);
        if have != need {
            return Err(differs("", have, need));
        }
        if need > rest {
            return Err(differs(" at most, by the file's length", rest, need));
        }
        Ok(stream)
    }

    /// The sizes of compressed blocks, which stand in a base64 text of their own.
    fn sizes(&mut self, need: u64) -> Result<Sizes, Wrong> {
        let word = self.word as u64;
        // The first letters tell how many there are; then the rest of the text is known.
        let mut coded = self.coded(word)?;
        let first = self.decoded(&coded)?;
        let count = number(first.get(..self.word).unwrap_or_default(), self.big_endian);
        let all = count.saturating_add(3).saturating_mul(word);
        if all > self.rest || count > need {
            let cause =
                format!("the array says that it has {count} compressed blocks, more than fit");
            return Err(Wrong::Lengths(cut_off(cause)));
        }
        let more = self.coded_len(all) - coded.len() as u64;
        coded.extend(self.take(more)?);
        let numbers = self.decoded(&coded)?;
        drop(coded);
        let mut sizes = Sizes {
            numbers,
            word: self.word,
            big_endian: self.big_endian,
            count,
            each: 0,
            last: 0,
            packed: 0,
        };
        (sizes.each, sizes.last) = (sizes.number(1), sizes.number(2));
        if sizes.last == 0 {
            sizes.last = sizes.each;
        }
        let whole = count.saturating_sub(1).saturating_mul(sizes.each);
        let have = if count == 0 {
            0
        } else {
            whole.saturating_add(sizes.last)
        };
        if have != need {
            return Err(differs(" in compressed blocks", have, need));
        }
        let packed = (0..count).fold(0_u64, |sum, block| {
            sum.saturating_add(sizes.packed_len(block))
        });
        if packed > self.rest {
            let cause = format!(
                "the compressed blocks have {packed} bytes; the file has {} at most",
                self.rest
            );
            return Err(Wrong::Lengths(cut_off(cause)));
        }
        sizes.packed = packed;
        Ok(sizes)
    }

    /// Letters or bytes that so many bytes take.
    fn coded_len(&self, len: u64) -> u64 {
        if self.base64 { letters(len) } else { len }
    }

    fn coded(&mut self, len: u64) -> io::Result<Vec<u8>> {
        self.take(self.coded_len(len))
    }

    /// Letters or bytes as they are in the file, as long as it has them.
    fn take(&mut self, len: u64) -> io::Result<Vec<u8>> {
        let mut coded = Vec::new();
        if self.base64 {
            let letters = Letters {
                reader: &mut self.reader,
                left: len,
            };
            { letters }.read_to_end(&mut coded)?;
        } else {
            (&mut self.reader).take(len).read_to_end(&mut coded)?;
        }
        if (coded.len() as u64) < len {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        Ok(coded)
    }

    fn decoded(&self, coded: &[u8]) -> io::Result<Vec<u8>> {
        if !self.base64 {
            return Ok(coded.to_vec());
        }
        let decoded = BASE64.decode(coded);
        decoded.map_err(|error| io::Error::new(ErrorKind::InvalidData, error))
    }
}

fn number(bytes: &[u8], big_endian: bool) -> u64 {
    let add = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
    if big_endian {
        bytes.iter().fold(0, add)
    } else {
        bytes.iter().rev().fold(0, add)
    }
}

/// The numbers before compressed blocks: how many, the length of each and of the last, the compressed lengths.
struct Sizes {
    numbers: Vec<u8>,
    word: usize,
    big_endian: bool,
    count: u64,
    each: u64,
    last: u64,
    /// Compressed bytes of all blocks.
    packed: u64,
}

impl Sizes {
    fn number(&self, index: u64) -> u64 {
        let at = usize::try_from(index)
            .unwrap_or(usize::MAX)
            .saturating_mul(self.word);
        let bytes = self
            .numbers
            .get(at..)
            .and_then(|rest| rest.get(..self.word));
        number(bytes.unwrap_or_default(), self.big_endian)
    }

    fn packed_len(&self, block: u64) -> u64 {
        self.number(3 + block)
    }

    fn len(&self, block: u64) -> u64 {
        if block + 1 == self.count {
            self.last
        } else {
            self.each
        }
    }
}

/// Decodes one block after the other.
struct Blocks<'a> {
    stream: Box<dyn Read + 'a>,
    compressor: Compressor,
    sizes: Sizes,
    next: u64,
    packed: Vec<u8>,
    block: Vec<u8>,
    at: usize,
}

impl Blocks<'_> {
    fn refill(&mut self) -> io::Result<()> {
        let invalid = |cause: String| io::Error::new(ErrorKind::InvalidData, cause);
        let (packed_len, len) = (self.sizes.packed_len(self.next), self.sizes.len(self.next));
        (self.at, self.next) = (0, self.next + 1);
        self.block.clear();
        self.packed.clear();
        (&mut self.stream)
            .take(packed_len)
            .read_to_end(&mut self.packed)?;
        if (self.packed.len() as u64) < packed_len {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        let wrong = |have: u64| invalid(format!("block {} has {have} bytes, not {len}", self.next));
        match self.compressor {
            Compressor::Lz4 => {
                // The decoder wants the whole block at once; no block grows more than by the ratio.
                if len > packed_len.saturating_mul(LZ4_RATIO) {
                    return Err(wrong(packed_len.saturating_mul(LZ4_RATIO)));
                }
                self.block
                    .resize(usize::try_from(len).unwrap_or(usize::MAX), 0);
                let decoded = lz4_flex::block::decompress_into(&self.packed, &mut self.block);
                let have = decoded.map_err(|error| invalid(error.to_string()))?;
                if have as u64 != len {
                    return Err(wrong(have as u64));
                }
            }
            Compressor::Lzma => {
                let decoder = XzReader::new_mem_limit(self.packed.as_slice(), false, LZMA_KIB);
                decoder
                    .take(len.saturating_add(1))
                    .read_to_end(&mut self.block)?;
                if self.block.len() as u64 != len {
                    return Err(wrong(self.block.len() as u64));
                }
            }
            Compressor::Zlib | Compressor::None => {
                let decoder = ZlibDecoder::new(self.packed.as_slice());
                decoder
                    .take(len.saturating_add(1))
                    .read_to_end(&mut self.block)?;
                if self.block.len() as u64 != len {
                    return Err(wrong(self.block.len() as u64));
                }
            }
        }
        Ok(())
    }
}

impl Read for Blocks<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        while self.at == self.block.len() {
            if self.next == self.sizes.count {
                return Ok(0);
            }
            self.refill()?;
        }
        let count = out.len().min(self.block.len() - self.at);
        out[..count].copy_from_slice(&self.block[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_an_order() {
        assert_eq!(
            (number(&[1, 2], true), number(&[1, 2], false)),
            (0x102, 0x201)
        );
    }
}
