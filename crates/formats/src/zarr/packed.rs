//! One step of packing undone: compression and checksums, never past the bytes that can be there.

use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};

use volgraph_volume::{Trouble, VolumeError};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Packed {
    Gzip,
    Zlib,
    Bzip2,
    Zstd,
    Blosc,
    Crc32c,
}

pub(super) fn broken(what: impl Into<String>) -> VolumeError {
    VolumeError::DataCorrupt(Trouble::new(what, "fetch the chunk again"))
}

impl Packed {
    pub fn of(name: &str) -> Option<Self> {
        Some(match name.strip_prefix("numcodecs.").unwrap_or(name) {
            "gzip" => Self::Gzip,
            "zlib" => Self::Zlib,
            "bz2" => Self::Bzip2,
            "zstd" => Self::Zstd,
            "blosc" => Self::Blosc,
            "crc32c" => Self::Crc32c,
            _ => return None,
        })
    }

    /// What `bytes` were made of, at most `most` bytes.
    pub fn undo(self, mut bytes: Vec<u8>, most: usize) -> Result<Vec<u8>, VolumeError> {
        match self {
            Self::Gzip => unpack(
                flate2::read::MultiGzDecoder::new(bytes.as_slice()),
                most,
                "gzip",
            ),
            Self::Zlib => unpack(
                flate2::read::ZlibDecoder::new(bytes.as_slice()),
                most,
                "zlib",
            ),
            Self::Bzip2 => unpack(
                bzip2::read::MultiBzDecoder::new(bytes.as_slice()),
                most,
                "bzip2",
            ),
            Self::Zstd => {
                let failed = |error: std::io::Error| {
                    broken(format!("the Zstandard stream is broken: {error}"))
                };
                let mut decoder =
                    zstd::stream::read::Decoder::with_buffer(bytes.as_slice()).map_err(failed)?;
                // The window is memory by the stream's word: no more than the chunk and 8 MiB, nor 128 MiB.
                let window = (most.max(1).ilog2() + 1).clamp(23, 27);
                decoder.window_log_max(window).map_err(failed)?;
                unpack(decoder, most, "Zstandard")
            }
            Self::Blosc => unblosc(&bytes, most),
            Self::Crc32c => {
                let at = bytes
                    .len()
                    .checked_sub(4)
                    .ok_or_else(|| broken("too short for its checksum"))?;
                let said = bytes.split_off(at);
                if crc32c::crc32c(&bytes).to_le_bytes() != said.as_slice() {
                    return Err(broken("the checksum (crc32c) is another"));
                }
                Ok(bytes)
            }
        }
    }
}

/// The stream to its end; it grows with what is really there.
fn unpack(stream: impl Read, most: usize, what: &str) -> Result<Vec<u8>, VolumeError> {
    let mut out = Vec::new();
    let read = stream.take(most as u64 + 1).read_to_end(&mut out);
    read.map_err(|error| broken(format!("the {what} stream is broken: {error}")))?;
    if out.len() > most {
        return Err(broken(format!(
            "the {what} stream holds more than {most} bytes"
        )));
    }
    Ok(out)
}

/// Blosc says the length in its header, and how many bytes of the input it is about.
fn unblosc(bytes: &[u8], most: usize) -> Result<Vec<u8>, VolumeError> {
    let number = |at: usize| -> Option<usize> {
        let bytes = bytes.get(at..at + 4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(bytes)).ok()
    };
    let (Some(len), Some(block), Some(packed)) = (number(4), number(8), number(12)) else {
        return Err(broken("too short for a Blosc header"));
    };
    let memory_copy = bytes.get(2).is_some_and(|flags| flags & 2 != 0);
    // A start for each block stands behind the header.
    let blocks = len.div_ceil(block.max(1));
    let least = if memory_copy {
        16 + len
    } else {
        16_usize.saturating_add(blocks.saturating_mul(4))
    };
    if len > most || packed != bytes.len() || len > 0 && (block == 0 || least > packed) {
        return Err(broken(format!(
            "the Blosc header says {len} bytes in blocks of {block} from {packed}; at most {most} from {} can be",
            bytes.len()
        )));
    }
    let mut out = decompress(bytes, len)?;
    // Blosc 1 leaves blocks as they are whose elements are no multiple of 8; the decoder shuffles what it can of
    // them, as Blosc 2 does. Without the flag it leaves all blocks: these are taken from there.
    let (format, flags, element) = (bytes[0], bytes[2], usize::from(bytes[3]).max(1));
    let left = |block: &[u8]| !(block.len() / element).is_multiple_of(8);
    if format <= 2 && flags & 4 != 0 && !memory_copy && len > 0 && out.chunks(block).any(left) {
        let mut plain = bytes.to_vec();
        plain[2] &= !4;
        let plain = decompress(&plain, len)?;
        let blocks = out.chunks_mut(block).zip(plain.chunks(block));
        blocks
            .filter(|(_, plain)| left(plain))
            .for_each(|(out, plain)| out.copy_from_slice(plain));
    }
    Ok(out)
}

fn decompress(bytes: &[u8], len: usize) -> Result<Vec<u8>, VolumeError> {
    let mut out = Vec::new();
    if out.try_reserve_exact(len).is_err() {
        return Err(broken("memory does not hold the chunk"));
    }
    out.resize(len, 0);
    // The decoder indexes by what the bytes say; a forged offset ends there and not here.
    let done = catch_unwind(AssertUnwindSafe(|| {
        blusc::blosc1_decompress(bytes, &mut out)
    }));
    match done {
        Ok(count) if usize::try_from(count) == Ok(len) => Ok(out),
        _ => Err(broken("the Blosc stream is broken")),
    }
}
