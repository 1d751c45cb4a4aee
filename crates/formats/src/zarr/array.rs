//! Boxes of an array out of its chunks.
//!
//! A box is filled with the fill value; then the chunks that it overlaps are read in batches, decoded in parallel
//! and copied in. Nothing is allocated by the metadata's word but the box that was asked for and chunks whose files
//! are there, and both are held against the limit first.

use std::fs::File;
use std::io::{self, ErrorKind, Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use volgraph_volume::{Element, ScalarType, Trouble, VolumeError, Voxels, for_scalar_type};

use super::codecs::{Codecs, Shard};
use super::metadata::Meta;
use crate::load::Limits;

/// Most chunks of one box: each costs a look at the disk.
const MOST_CHUNKS: u128 = 1 << 20;

/// Bytes of chunks that are decoded before they are copied.
const BATCH_BYTES: u64 = 1 << 28;

/// An array whose metadata was read.
#[derive(Debug)]
pub(super) struct Array {
    pub meta: Meta,
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
        self.size.iter().try_fold(1_u64, |product, &n| product.checked_mul(n))
    }

    /// What both have; `None` where that is nothing.
    fn overlap(&self, other: &Self) -> Option<Self> {
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
    fn cells(&self, cell: &[u64]) -> Vec<(u64, u64)> {
        let ends = self.origin.iter().zip(&self.size).zip(cell);
        ends.map(|((&from, &size), &cell)| (from / cell, (from + size).div_ceil(cell))).collect()
    }
}

/// One chunk to be read.
struct Task {
    file: PathBuf,
    /// Where it lies in a shard.
    range: Option<(u64, u64)>,
    place: Box,
}

impl Array {
    pub fn new(folder: &Path, meta: Meta) -> Self {
        Self {
            meta,
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
            || inside.into_iter().any(|((from, size), n)| from.checked_add(*size).is_none_or(|end| end > *n))
        {
            return Err(VolumeError::Option(Trouble::new(
                format!("there is no box {wanted:?} in an array of {:?}", self.meta.shape),
                "ask for voxels inside of the array",
            )));
        }
        let too_large = |what: &str, remedy: &str| {
            VolumeError::TooLarge(Trouble::new(
                format!("{what} of {:?} pass the limit of {} bytes", self.meta.shape, limits.max_bytes),
                remedy,
            ))
        };
        let fits = |count: Option<u64>, size: usize| {
            let bytes = count.and_then(|count| count.checked_mul(size as u64));
            bytes.is_some_and(|bytes| bytes <= limits.max_bytes && usize::try_from(bytes).is_ok())
        };
        let (element, fill) = (self.meta.element, &self.meta.fill);
        if !fits(wanted.count(), element.scalar_type.size()) {
            return Err(too_large("the voxels wanted", "take a coarser level, or raise the limit (max_bytes)"));
        }
        let chunk = self.chunk().iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
        if !fits(chunk, element.size) {
            return Err(too_large("chunks of an array", "save the array with smaller chunks"));
        }
        let count = usize::try_from(wanted.count().unwrap_or(0)).unwrap_or(usize::MAX);
        let stored = if element.is_half() { ScalarType::U16 } else { element.scalar_type };
        let voxels = for_scalar_type!(stored, T => {
            let mut values: Vec<T> = Vec::new();
            if values.try_reserve_exact(count).is_err() {
                return Err(too_large("the voxels wanted", "free memory, or take a coarser level"));
            }
            values.resize(count, bytemuck::pod_read_unaligned::<T>(fill));
            self.fill(bytemuck::cast_slice_mut(&mut values), wanted, needed, limits)?;
            Element::wrap(values)
        });
        Ok(match voxels {
            Voxels::U16(halves) if element.is_half() => {
                let floats = halves.par_iter().map(|&bits| half::f16::from_bits(bits).to_f32());
                Voxels::F32(floats.collect())
            }
            other => other,
        })
    }

    fn fill(&self, out: &mut [u8], wanted: &Box, needed: &Box, limits: &Limits) -> Result<(), VolumeError> {
        let Some(needed) = wanted.overlap(needed) else {
            return Ok(());
        };
        let cells = needed.cells(self.chunk());
        let chunks: u128 = cells.iter().map(|&(from, end)| u128::from(end - from)).product();
        if chunks > MOST_CHUNKS {
            return Err(VolumeError::TooLarge(Trouble::new(
                format!("{chunks} chunks of {:?} are more than {MOST_CHUNKS}", self.chunk()),
                "save the array with larger chunks, or take a coarser level",
            )));
        }
        let size = self.meta.element.size;
        let chunk_bytes = self.chunk().iter().product::<u64>().saturating_mul(size as u64);
        let most = usize::try_from(BATCH_BYTES / chunk_bytes.max(1)).unwrap_or(usize::MAX);
        let most = most.clamp(1, 8 * rayon::current_num_threads());
        let mut run = Run {
            array: self,
            out,
            wanted,
            limits,
            most,
            tasks: Vec::new(),
            chunks: 0,
            of: chunks as u64,
        };
        let outer = needed.cells(&self.meta.chunk);
        each_index(&outer, |index| {
            let file = self.folder.join(self.meta.keys.name(index));
            let place = cell(index, &self.meta.chunk);
            match &self.meta.codecs.shard {
                None => run.push(Task { file, range: None, place }),
                Some(shard) => run.push_shard(shard, &file, &place, &needed),
            }
        })?;
        run.flush()
    }

    /// The chunk's voxels in the order they are stored; `None` where it is missing.
    fn decoded(&self, task: &Task) -> Result<Option<Vec<u8>>, VolumeError> {
        let size = self.meta.element.size;
        let codecs = self.inner();
        // It was held against the limit, which fits.
        let len = task.place.size.iter().product::<u64>() as usize * size;
        let read = || -> Result<Option<Vec<u8>>, VolumeError> {
            let Some(mut open) = Open::file(&task.file)? else {
                return Ok(None);
            };
            let (from, bytes) = task.range.unwrap_or((0, open.len));
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

    fn inner(&self) -> &Codecs {
        match &self.meta.codecs.shard {
            Some(shard) => &shard.codecs,
            None => &self.meta.codecs,
        }
    }
}

/// A cell of a regular grid.
fn cell(index: &[u64], size: &[u64]) -> Box {
    Box {
        origin: index.iter().zip(size).map(|(i, n)| i.saturating_mul(*n)).collect(),
        size: size.to_vec(),
    }
}

/// Calls for every index of the ranges, the last fastest.
fn each_index(
    ranges: &[(u64, u64)],
    mut call: impl FnMut(&[u64]) -> Result<(), VolumeError>,
) -> Result<(), VolumeError> {
    let mut index: Vec<u64> = ranges.iter().map(|range| range.0).collect();
    loop {
        call(&index)?;
        let Some(axis) = (0..index.len()).rev().find(|&axis| index[axis] + 1 < ranges[axis].1) else {
            return Ok(());
        };
        index[axis] += 1;
        for later in axis + 1..index.len() {
            index[later] = ranges[later].0;
        }
    }
}

/// A chunk's file.
struct Open {
    file: File,
    len: u64,
}

impl Open {
    /// `None` where there is none.
    fn file(path: &Path) -> Result<Option<Self>, VolumeError> {
        let open = || -> io::Result<Option<Self>> {
            let file = match File::open(path) {
                Ok(file) => file,
                Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                    return Ok(None);
                }
                Err(error) => return Err(error),
            };
            let metadata = file.metadata()?;
            if !metadata.is_file() {
                return Err(io::Error::other("is no regular file"));
            }
            let len = metadata.len();
            Ok(Some(Self { file, len }))
        };
        open().map_err(|error| unreadable(path, &error))
    }

    /// Bytes that are known to be in the file.
    fn read(&mut self, from: u64, count: u64) -> Result<Vec<u8>, VolumeError> {
        let mut bytes = Vec::new();
        let read = || -> io::Result<usize> {
            self.file.seek(SeekFrom::Start(from))?;
            (&mut self.file).take(count).read_to_end(&mut bytes)
        };
        let mut read = read;
        match read() {
            Ok(got) if got as u64 == count => Ok(bytes),
            Ok(got) => Err(VolumeError::DataTooShort(Trouble::new(
                format!("has {got} of {count} bytes"),
                "fetch the chunk again",
            ))),
            Err(error) => Err(unreadable(Path::new(""), &error)),
        }
    }
}

fn unreadable(path: &Path, error: &io::Error) -> VolumeError {
    VolumeError::Unreadable(Trouble::new(
        format!("cannot be read: {error}"),
        "check the file, its permissions and the disk",
    ))
    .in_file(path)
}

/// Chunks on their way into a box.
struct Run<'a> {
    array: &'a Array,
    out: &'a mut [u8],
    wanted: &'a Box,
    limits: &'a Limits,
    /// Tasks of a batch.
    most: usize,
    tasks: Vec<Task>,
    chunks: u64,
    of: u64,
}

impl Run<'_> {
    fn push(&mut self, task: Task) -> Result<(), VolumeError> {
        self.tasks.push(task);
        if self.tasks.len() >= self.most { self.flush() } else { Ok(()) }
    }

    /// The inner chunks of a shard that are needed and there.
    fn push_shard(&mut self, shard: &Shard, file: &Path, place: &Box, needed: &Box) -> Result<(), VolumeError> {
        let Some(mut open) = Open::file(file)? else {
            return Ok(());
        };
        let counts: Vec<u64> = place.size.iter().zip(&shard.chunk).map(|(outer, inner)| outer / inner).collect();
        let mut index = || {
            let count = counts.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
            let count = count.unwrap_or(u64::MAX);
            let (from, size) = shard.index_range(count, open.len)?;
            shard.index(open.read(from, size)?, count, open.len)
        };
        let index = index().map_err(|error| error.in_file(file))?;
        let Some(here) = place.overlap(needed) else {
            return Ok(());
        };
        let local = Box {
            origin: here.origin.iter().zip(&place.origin).map(|(a, b)| a - b).collect(),
            size: here.size,
        };
        each_index(&local.cells(&shard.chunk), |inner| {
            let at = inner.iter().zip(&counts).fold(0, |at, (i, n)| at * n + i);
            let Some(range) = index.get(at as usize).copied().flatten() else {
                return Ok(());
            };
            let mut chunk = cell(inner, &shard.chunk);
            for (origin, outer) in chunk.origin.iter_mut().zip(&place.origin) {
                *origin = origin.saturating_add(*outer);
            }
            self.push(Task {
                file: file.to_path_buf(),
                range: Some(range),
                place: chunk,
            })
        })
    }

    fn flush(&mut self) -> Result<(), VolumeError> {
        let tasks = std::mem::take(&mut self.tasks);
        let decoded: Vec<_> = tasks.par_iter().map(|task| self.array.decoded(task)).collect();
        for (task, bytes) in tasks.iter().zip(decoded) {
            if let Some(bytes) = bytes? {
                self.copy(&task.place, &bytes);
            }
            self.chunks += 1;
        }
        let total = self.out.len() as u64;
        let part = u128::from(total) * u128::from(self.chunks) / u128::from(self.of.max(1));
        self.limits.report(part as u64, total);
        Ok(())
    }

    /// Copies what a chunk has of the box.
    fn copy(&mut self, place: &Box, bytes: &[u8]) {
        let Some(both) = place.overlap(self.wanted) else {
            return;
        };
        let size = self.array.meta.element.size;
        let from = self.array.inner().strides(&place.size);
        let mut to = vec![1_usize; from.len()];
        for axis in (1..to.len()).rev() {
            to[axis - 1] = to[axis] * self.wanted.size[axis] as usize;
        }
        let last = from.len() - 1;
        let row = both.size[last] as usize;
        // All indices but the last, relative to the overlap.
        let ranges: Vec<(u64, u64)> = both.size[..last].iter().map(|&n| (0, n)).collect();
        let start = |origin: &[u64], strides: &[usize]| -> usize {
            let offsets = both.origin.iter().zip(origin).zip(strides);
            offsets.map(|((at, origin), stride)| (at - origin) as usize * stride).sum()
        };
        let (from_start, to_start) = (start(&place.origin, &from), start(&self.wanted.origin, &to));
        let out = &mut *self.out;
        let copied = each_index(&ranges, |index| {
            let offset = |strides: &[usize]| -> usize {
                index.iter().zip(strides).map(|(i, stride)| *i as usize * stride).sum()
            };
            let (source, target) = (from_start + offset(&from), to_start + offset(&to));
            let target = &mut out[target * size..(target + row) * size];
            if from[last] == 1 {
                target.copy_from_slice(&bytes[source * size..(source + row) * size]);
            } else {
                for (i, target) in target.chunks_exact_mut(size).enumerate() {
                    let at = (source + i * from[last]) * size;
                    target.copy_from_slice(&bytes[at..at + size]);
                }
            }
            Ok(())
        });
        debug_assert!(copied.is_ok());
    }
}
