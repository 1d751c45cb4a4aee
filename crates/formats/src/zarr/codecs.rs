//! From the bytes of a chunk to its voxels.
//!
//! The codecs of the file's metadata, read once into a chain; decoding runs it backwards. Every step is bounded by
//! the size that the chunk must have, so no stream can make more of itself; voxels that lie in another order than
//! the array's stay so, and [`Codecs::strides`] says where they are.

use volgraph_volume::{Trouble, VolumeError};
use zarrs_metadata::v3::MetadataV3;

use super::packed::{Packed, broken};

/// How chunks are encoded.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Codecs {
    /// Axis of the array at each place of the stored chunk.
    order: Vec<usize>,
    pub big_endian: bool,
    /// In the order of encoding.
    packed: Vec<Packed>,
    /// Chunks inside of chunks.
    pub shard: Option<Box<Shard>>,
}

/// A shard's inside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shard {
    /// Shape of an inner chunk.
    pub chunk: Vec<u64>,
    pub codecs: Codecs,
    /// How the index is encoded: 64-bit numbers, perhaps with a checksum.
    index: Codecs,
    index_first: bool,
}

fn unsupported(what: impl Into<String>) -> VolumeError {
    VolumeError::Unsupported(Trouble::new(
        what,
        "save the array with bytes and none or one of gzip, zlib, bz2, zstd, blosc and crc32c",
    ))
}

impl Codecs {
    /// The chain of Zarr v3's metadata for chunks of a rank.
    pub fn of_v3(list: &[MetadataV3], rank: usize) -> Result<Self, VolumeError> {
        let mut codecs = Self {
            order: (0..rank).collect(),
            big_endian: false,
            packed: Vec::new(),
            shard: None,
        };
        let mut bytes = false;
        for codec in list {
            let name = codec.name();
            let config = codec.configuration();
            let said = |key: &str| config.and_then(|config| config.get(key));
            match name {
                "transpose" if !bytes => codecs.transpose(said("order"))?,
                "bytes" | "endian" if !bytes => {
                    bytes = true;
                    codecs.big_endian = match said("endian").and_then(|value| value.as_str()) {
                        Some("big") => true,
                        Some("little") | None => false,
                        Some(other) => {
                            return Err(unsupported(format!("the byte order {other:?}")));
                        }
                    };
                }
                "sharding_indexed" if !bytes => {
                    bytes = true;
                    codecs.shard = Some(Box::new(Shard::of(said, rank)?));
                }
                _ => match Packed::of(name).filter(|_| bytes) {
                    Some(packed) => codecs.packed.push(packed),
                    None => {
                        return Err(unsupported(format!("the codec {name:?} is not read here")));
                    }
                },
            }
        }
        if !bytes {
            return Err(unsupported("no codec makes bytes of the voxels"));
        }
        let sorted = codecs.order.iter().enumerate().all(|(i, &axis)| i == axis);
        if codecs.shard.is_some() && !(codecs.packed.is_empty() && sorted) {
            return Err(unsupported(
                "shards that are turned or packed as a whole are not read",
            ));
        }
        if codecs
            .shard
            .as_ref()
            .is_some_and(|shard| shard.codecs.shard.is_some())
        {
            return Err(unsupported("shards inside of shards are not read"));
        }
        Ok(codecs)
    }

    /// The chain of Zarr v2: order, byte order and compressor.
    pub fn of_v2(
        rank: usize,
        column_major: bool,
        big_endian: bool,
        compressor: Option<&str>,
    ) -> Result<Self, VolumeError> {
        let mut order: Vec<usize> = (0..rank).collect();
        if column_major {
            order.reverse();
        }
        let packed = match compressor {
            None => Vec::new(),
            Some(name) => match Packed::of(name) {
                Some(packed) => vec![packed],
                None => {
                    return Err(unsupported(format!(
                        "the compressor {name:?} is not read here"
                    )));
                }
            },
        };
        Ok(Self {
            order,
            big_endian,
            packed,
            shard: None,
        })
    }

    fn transpose(&mut self, order: Option<&serde_json::Value>) -> Result<(), VolumeError> {
        let rank = self.order.len();
        let said: Option<Vec<usize>> = match order {
            Some(serde_json::Value::String(name)) if name == "C" => Some((0..rank).collect()),
            Some(serde_json::Value::String(name)) if name == "F" => Some((0..rank).rev().collect()),
            Some(serde_json::Value::Array(list)) => list
                .iter()
                .map(|axis| usize::try_from(axis.as_u64()?).ok())
                .collect(),
            _ => None,
        };
        let right = |said: &Vec<usize>| {
            let mut sorted = said.clone();
            sorted.sort_unstable();
            sorted.into_iter().eq(0..rank)
        };
        let said = said.filter(right).ok_or_else(|| {
            VolumeError::BadValue(Trouble::new(
                format!("the codec `transpose` has no order of {rank} axes"),
                "list each axis once",
            ))
        })?;
        self.order = said.iter().map(|&axis| self.order[axis]).collect();
        Ok(())
    }

    /// Elements from one voxel to the next along each axis of the array, in a chunk of this shape.
    pub fn strides(&self, shape: &[u64]) -> Vec<usize> {
        let mut strides = vec![0; shape.len()];
        let mut stride = 1_usize;
        for &axis in self.order.iter().rev() {
            strides[axis] = stride;
            stride = stride.saturating_mul(usize::try_from(shape[axis]).unwrap_or(usize::MAX));
        }
        strides
    }

    /// `len` bytes of voxels in the machine's order out of what is stored; elements have `size` bytes.
    pub fn decode(
        &self,
        mut bytes: Vec<u8>,
        len: usize,
        size: usize,
    ) -> Result<Vec<u8>, VolumeError> {
        // Between two codecs there may be a little more: headers and checksums.
        let between = len.saturating_add(len / 4).saturating_add(1 << 16);
        for (left, packed) in (0..self.packed.len()).rev().zip(self.packed.iter().rev()) {
            bytes = packed.undo(bytes, if left == 0 { len } else { between })?;
        }
        if bytes.len() != len {
            return Err(broken(format!(
                "a chunk of {} bytes, and it needs {len}",
                bytes.len()
            )));
        }
        if self.big_endian != cfg!(target_endian = "big") && size > 1 {
            bytes.chunks_exact_mut(size).for_each(<[u8]>::reverse);
        }
        Ok(bytes)
    }

    /// Whether the encoded length is the decoded one.
    pub fn is_plain(&self) -> bool {
        self.packed.is_empty()
    }

    fn fixed_len(&self, len: u64) -> Option<u64> {
        self.packed
            .iter()
            .try_fold(len, |len, packed| match packed {
                Packed::Crc32c => len.checked_add(4),
                _ => None,
            })
    }
}

impl Shard {
    fn of<'a>(
        said: impl Fn(&str) -> Option<&'a serde_json::Value>,
        rank: usize,
    ) -> Result<Self, VolumeError> {
        let bad = |what: &str| {
            VolumeError::BadValue(Trouble::new(
                format!("the codec `sharding_indexed` has no valid {what}"),
                "correct the metadata",
            ))
        };
        let chunk: Option<Vec<u64>> = said("chunk_shape")
            .and_then(|value| value.as_array())
            .and_then(|list| list.iter().map(serde_json::Value::as_u64).collect());
        let chunk = chunk.filter(|chunk| chunk.len() == rank && !chunk.contains(&0));
        let list = |key: &str| -> Result<Vec<MetadataV3>, VolumeError> {
            let value = said(key).ok_or_else(|| bad(key))?;
            serde_json::from_value(value.clone()).map_err(|_| bad(key))
        };
        let index_first = match said("index_location").and_then(|value| value.as_str()) {
            Some("start") => true,
            Some("end") | None => false,
            Some(_) => return Err(bad("index_location")),
        };
        let index = Codecs::of_v3(&list("index_codecs")?, rank + 1)?;
        if index.fixed_len(16).is_none()
            || index.shard.is_some()
            || index.order != Vec::from_iter(0..=rank)
        {
            return Err(bad("index_codecs"));
        }
        Ok(Self {
            chunk: chunk.ok_or_else(|| bad("chunk_shape"))?,
            codecs: Codecs::of_v3(&list("codecs")?, rank)?,
            index,
            index_first,
        })
    }

    /// Where the index of `count` inner chunks lies in a shard of `len` bytes; refused where it does not fit.
    pub fn index_range(&self, count: u64, len: u64) -> Result<(u64, u64), VolumeError> {
        let size = count
            .checked_mul(16)
            .and_then(|size| self.index.fixed_len(size));
        let size = size.filter(|&size| size <= len).ok_or_else(|| {
            broken(format!(
                "a shard of {len} bytes has no room for the index of {count} chunks"
            ))
        })?;
        Ok((if self.index_first { 0 } else { len - size }, size))
    }

    /// Offset and length of each inner chunk; `None` where it is missing.
    pub fn index(
        &self,
        bytes: Vec<u8>,
        count: u64,
        len: u64,
    ) -> Result<Vec<Option<(u64, u64)>>, VolumeError> {
        let bytes =
            self.index
                .decode(bytes, usize::try_from(count * 16).unwrap_or(usize::MAX), 8)?;
        let number = |bytes: &[u8]| bytes.try_into().map_or(0, u64::from_ne_bytes);
        bytes
            .chunks_exact(16)
            .map(|entry| {
                let (offset, size) = (number(&entry[..8]), number(&entry[8..]));
                if (offset, size) == (u64::MAX, u64::MAX) {
                    return Ok(None);
                }
                match offset.checked_add(size) {
                    Some(end) if end <= len => Ok(Some((offset, size))),
                    _ => Err(broken(format!(
                        "the shard's index has {size} bytes at {offset}, and the shard has {len}"
                    ))),
                }
            })
            .collect()
    }
}
