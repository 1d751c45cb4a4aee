//! Boxes of an array out of its chunks.
//!
//! A box is filled with the fill value; then the chunks that it overlaps are read in batches, decoded in parallel
//! and copied in. Nothing is allocated by the metadata's word but the box that was asked for and chunks whose files
//! are there, and both are held against the limit first.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use volgraph_volume::{Element, ScalarType, Trouble, VolumeError, Voxels, for_scalar_type};

use super::codecs::Codecs;
use super::metadata::Meta;
use super::run::{Run, Task, cell, each_index};
use super::store::Store;
use crate::load::Limits;

/// Most chunks of one box: each costs a look at the disk.
const MOST_CHUNKS: u128 = 1 << 20;

/// Bytes of chunks that are decoded before they are copied.
pub(super) const BATCH_BYTES: u64 = 1 << 28;

/// Bytes that may be nothing but the fill value.
const FREE_BYTES: u64 = 1 << 26;

/// Bytes of voxels for each byte that the chunks can hold: arrays of labels have few chunks that are not empty.
const MOST_FILL: u64 = 4096;

/// Bytes that a packed one may become; Zstandard and Blosc know no limit, blocks of one value come to this.
const MOST_RATIO: u64 = 1 << 15;

/// An array whose metadata was read.
#[derive(Debug)]
pub(super) struct Array {
    pub meta: Meta,
    pub store: Store,
    folder: PathBuf,
}

/// A box of elements: first index and size along each axis, slowest first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Box {
    pub origin: Vec<u64>,
    pub size: Vec<u64>,
}

impl Box {
    fn count(&self) -> Option<u64> {
        self.size
            .iter()
            .try_fold(1_u64, |product, &n| product.checked_mul(n))
    }

    /// What both have; `None` where that is nothing.
    pub fn overlap(&self, other: &Self) -> Option<Self> {
        let mut both = self.clone();
        for axis in 0..self.size.len() {
            let low = self.origin[axis].max(other.origin[axis]);
            let end = |of: &Self| of.origin[axis].saturating_add(of.size[axis]);
            let high = end(self).min(end(other));
            if low >= high {
                return None;
            }
            (both.origin[axis], both.size[axis]) = (low, high - low);
        }
        Some(both)
    }

    /// Indices of the cells of a regular grid that the box touches, first and behind the last.
    pub fn cells(&self, cell: &[u64]) -> Vec<(u64, u64)> {
        let ends = self.origin.iter().zip(&self.size).zip(cell);
        ends.map(|((&from, &size), &cell)| (from / cell, (from + size).div_ceil(cell)))
            .collect()
    }
}

impl Array {
    pub fn new(store: &Store, folder: &Path, meta: Meta) -> Self {
        Self {
            meta,
            store: store.clone(),
            folder: folder.to_path_buf(),
        }
    }

    /// Shape of what is read at once: a chunk, or the inner one of a shard.
    pub fn chunk(&self) -> &[u64] {
        match &self.meta.codecs.shard {
            Some(shard) => &shard.chunk,
            None => &self.meta.chunk,
        }
    }

    /// The elements of a box, the last axis fastest. Of these the ones in `needed` are read; the others stay the fill
    /// value.
    pub fn read(&self, wanted: &Box, needed: &Box, limits: &Limits) -> Result<Voxels, VolumeError> {
        let inside = wanted.origin.iter().zip(&wanted.size).zip(&self.meta.shape);
        if wanted.origin.len() != self.meta.shape.len()
            || inside
                .into_iter()
                .any(|((from, size), n)| from.checked_add(*size).is_none_or(|end| end > *n))
        {
            return Err(VolumeError::Option(Trouble::new(
                format!(
                    "there is no box {wanted:?} in an array of {:?}",
                    self.meta.shape
                ),
                "ask for voxels inside of the array",
            )));
        }
        let too_large = |what: &str, remedy: &str| {
            VolumeError::TooLarge(Trouble::new(
                format!(
                    "{what} of {:?} pass the limit of {} bytes",
                    self.meta.shape, limits.max_bytes
                ),
                remedy,
            ))
        };
        let fits = |count: Option<u64>, size: usize| {
            let bytes = count.and_then(|count| count.checked_mul(size as u64));
            bytes.is_some_and(|bytes| bytes <= limits.max_bytes && usize::try_from(bytes).is_ok())
        };
        let (element, fill) = (self.meta.element, &self.meta.fill);
        if !fits(wanted.count(), element.scalar_type.size()) {
            return Err(too_large(
                "the voxels wanted",
                "take a coarser level, or raise the limit (max_bytes)",
            ));
        }
        let chunk = self
            .chunk()
            .iter()
            .try_fold(1_u64, |product, &n| product.checked_mul(n));
        if !fits(chunk, element.size) {
            return Err(too_large(
                "chunks of an array",
                "save the array with smaller chunks",
            ));
        }
        let chunks = wanted
            .overlap(needed)
            .map_or(Ok(0), |needed| self.chunks(&needed))?;
        let count = usize::try_from(wanted.count().unwrap_or(0)).unwrap_or(usize::MAX);
        let stored = if element.is_half() {
            ScalarType::U16
        } else {
            element.scalar_type
        };
        let voxels = for_scalar_type!(stored, T => {
            let mut values: Vec<T> = Vec::new();
            if values.try_reserve_exact(count).is_err() {
                return Err(too_large("the voxels wanted", "free memory, or take a coarser level"));
            }
            values.resize(count, bytemuck::pod_read_unaligned::<T>(fill));
            self.fill(bytemuck::cast_slice_mut(&mut values), wanted, needed, chunks, limits)?;
            Element::wrap(values)
        });
        Ok(match voxels {
            Voxels::U16(halves) if element.is_half() => {
                let floats = halves
                    .par_iter()
                    .map(|&bits| half::f16::from_bits(bits).to_f32());
                Voxels::F32(floats.collect())
            }
            other => other,
        })
    }

    /// Refuses a large box of which next to nothing is there: metadata alone shall not fill the memory with the fill
    /// value. `needed` are the voxels of it whose chunks are read.
    pub fn check_there(&self, wanted: &Box, needed: &Box) -> Result<(), VolumeError> {
        let size = self.meta.element.scalar_type.size() as u64;
        let bytes = wanted.count().unwrap_or(u64::MAX).saturating_mul(size);
        if bytes <= FREE_BYTES {
            return Ok(());
        }
        self.chunks(needed)?;
        let chunk = self.meta.chunk.iter();
        let chunk_bytes = chunk.fold(size, |product, &n| product.saturating_mul(n));
        let ratio = if self.inner().is_plain() {
            1
        } else {
            MOST_RATIO
        };
        let mut there = 0_u64;
        each_index(&needed.cells(&self.meta.chunk), |index| {
            if there.saturating_mul(MOST_FILL) < bytes {
                let file = self.folder.join(self.meta.keys.name(index));
                let len = self.store.len(&file);
                there = there.saturating_add(len.saturating_mul(ratio).min(chunk_bytes));
            }
            Ok(())
        })?;
        if there.saturating_mul(MOST_FILL) < bytes {
            return Err(VolumeError::DataTooShort(Trouble::new(
                format!(
                    "next to no chunk is there: of {bytes} bytes of voxels all but {there} would be the fill value"
                ),
                "fetch the whole folder again, or correct the shape in its metadata",
            )));
        }
        Ok(())
    }

    /// How many chunks a box touches; refused where they are too many to look for.
    fn chunks(&self, needed: &Box) -> Result<u64, VolumeError> {
        let cells = needed.cells(self.chunk());
        let chunks: u128 = cells
            .iter()
            .map(|&(from, end)| u128::from(end - from))
            .product();
        if chunks > MOST_CHUNKS {
            return Err(VolumeError::TooLarge(Trouble::new(
                format!(
                    "{chunks} chunks of {:?} are more than {MOST_CHUNKS}",
                    self.chunk()
                ),
                "save the array with larger chunks, or take a coarser level",
            )));
        }
        Ok(chunks as u64)
    }

    fn fill(
        &self,
        out: &mut [u8],
        wanted: &Box,
        needed: &Box,
        chunks: u64,
        limits: &Limits,
    ) -> Result<(), VolumeError> {
        let Some(needed) = wanted.overlap(needed) else {
            return Ok(());
        };
        let size = self.meta.element.size;
        let chunk_bytes = self
            .chunk()
            .iter()
            .product::<u64>()
            .saturating_mul(size as u64);
        let most = usize::try_from(BATCH_BYTES / chunk_bytes.max(1)).unwrap_or(usize::MAX);
        let most = most.clamp(1, 8 * rayon::current_num_threads());
        let mut run = Run {
            array: self,
            out,
            wanted,
            limits,
            most,
            tasks: Vec::new(),
            shards: 0,
            held: 0,
            chunks: 0,
            of: chunks,
        };
        let outer = needed.cells(&self.meta.chunk);
        each_index(&outer, |index| {
            let file = self.folder.join(self.meta.keys.name(index));
            let place = cell(index, &self.meta.chunk);
            match &self.meta.codecs.shard {
                None => run.push(Task {
                    file,
                    open: None,
                    range: None,
                    place,
                }),
                Some(shard) => run.push_shard(shard, &file, &place, &needed),
            }
        })?;
        run.flush()
    }

    /// The chunk's voxels in the order they are stored; `None` where it is missing.
    pub fn decoded(&self, task: &Task) -> Result<Option<Vec<u8>>, VolumeError> {
        let size = self.meta.element.size;
        let codecs = self.inner();
        // It was held against the limit, which fits.
        let len = task.place.size.iter().product::<u64>() as usize * size;
        let read = || -> Result<Option<Vec<u8>>, VolumeError> {
            let opened;
            let open = match &task.open {
                Some(open) => open.as_ref(),
                None => match self.store.open(&task.file, most_packed(len as u64))? {
                    Some(open) => {
                        opened = open;
                        &opened
                    }
                    None => return Ok(None),
                },
            };
            let (from, bytes) = task.range.unwrap_or((0, open.len()));
            if codecs.is_plain() && bytes != len as u64 {
                return Err(VolumeError::DataCorrupt(Trouble::new(
                    format!("a chunk of {bytes} bytes, and it needs {len}"),
                    "fetch the chunk again",
                )));
            }
            codecs.decode(open.read(from, bytes)?, len, size).map(Some)
        };
        read().map_err(|error| error.in_file(&task.file))
    }

    pub fn inner(&self) -> &Codecs {
        match &self.meta.codecs.shard {
            Some(shard) => &shard.codecs,
            None => &self.meta.codecs,
        }
    }
}

/// Most bytes of a file that has so many bytes of voxels: packing may make them a little more.
pub(super) fn most_packed(len: u64) -> u64 {
    len.saturating_add(len / 4).saturating_add(1 << 16)
}
