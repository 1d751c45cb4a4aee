//! Chunks on their way into a box: looked for, read and decoded in batches, copied.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayon::prelude::*;
use volgraph_volume::VolumeError;

use super::array::{Array, BATCH_BYTES, Box, most_packed};
use super::codecs::Shard;
use super::store::Open;
use crate::load::Limits;

/// Most shards that are open at a time: systems have a limit on files.
const MOST_SHARDS: u64 = 64;

/// One chunk to be read.
pub(super) struct Task {
    pub file: PathBuf,
    /// The file, where it was opened before: shards have many chunks.
    pub open: Option<Arc<Open>>,
    /// Where it lies in a shard.
    pub range: Option<(u64, u64)>,
    pub place: Box,
}

/// A cell of a regular grid.
pub(super) fn cell(index: &[u64], size: &[u64]) -> Box {
    Box {
        origin: index
            .iter()
            .zip(size)
            .map(|(i, n)| i.saturating_mul(*n))
            .collect(),
        size: size.to_vec(),
    }
}

/// Calls for every index of the ranges, the last fastest.
pub(super) fn each_index(
    ranges: &[(u64, u64)],
    mut call: impl FnMut(&[u64]) -> Result<(), VolumeError>,
) -> Result<(), VolumeError> {
    let mut index: Vec<u64> = ranges.iter().map(|range| range.0).collect();
    loop {
        call(&index)?;
        let Some(axis) = (0..index.len())
            .rev()
            .find(|&axis| index[axis] + 1 < ranges[axis].1)
        else {
            return Ok(());
        };
        index[axis] += 1;
        for later in axis + 1..index.len() {
            index[later] = ranges[later].0;
        }
    }
}

/// Chunks on their way into a box.
pub(super) struct Run<'a> {
    pub array: &'a Array,
    pub out: &'a mut [u8],
    pub wanted: &'a Box,
    pub limits: &'a Limits,
    /// Tasks of a batch.
    pub most: usize,
    pub tasks: Vec<Task>,
    /// Shards that tasks of the batch hold open, and the bytes of those that are in memory.
    pub shards: u64,
    pub held: u64,
    pub chunks: u64,
    pub of: u64,
}

impl Run<'_> {
    pub fn push(&mut self, task: Task) -> Result<(), VolumeError> {
        self.tasks.push(task);
        if self.tasks.len() >= self.most {
            self.flush()
        } else {
            Ok(())
        }
    }

    /// The inner chunks of a shard that are needed and there.
    pub fn push_shard(
        &mut self,
        shard: &Shard,
        file: &Path,
        place: &Box,
        needed: &Box,
    ) -> Result<(), VolumeError> {
        let voxels = place
            .size
            .iter()
            .fold(1_u64, |all, &n| all.saturating_mul(n));
        let size = self.array.meta.element.size as u64;
        // Each chunk has a place in the index, and may be packed into more than it was.
        let most = most_packed(voxels.saturating_mul(size.saturating_add(16)));
        if self.shards >= MOST_SHARDS || self.held >= BATCH_BYTES {
            self.flush()?;
        }
        let Some(open) = self.array.store.open(file, most)? else {
            return Ok(());
        };
        self.shards += 1;
        self.held = self.held.saturating_add(open.bytes_in_memory());
        let open = Arc::new(open);
        let counts: Vec<u64> = place
            .size
            .iter()
            .zip(&shard.chunk)
            .map(|(outer, inner)| outer / inner)
            .collect();
        let index = || {
            let count = counts
                .iter()
                .try_fold(1_u64, |product, &n| product.checked_mul(n));
            let count = count.unwrap_or(u64::MAX);
            let (from, size) = shard.index_range(count, open.len())?;
            shard.index(open.read(from, size)?, count, open.len())
        };
        let index = index().map_err(|error| error.in_file(file))?;
        let Some(here) = place.overlap(needed) else {
            return Ok(());
        };
        let local = Box {
            origin: here
                .origin
                .iter()
                .zip(&place.origin)
                .map(|(a, b)| a - b)
                .collect(),
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
                open: Some(Arc::clone(&open)),
                range: Some(range),
                place: chunk,
            })
        })
    }

    pub fn flush(&mut self) -> Result<(), VolumeError> {
        let tasks = std::mem::take(&mut self.tasks);
        (self.shards, self.held) = (0, 0);
        let decoded: Vec<_> = tasks
            .par_iter()
            .map(|task| self.array.decoded(task))
            .collect();
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
            offsets
                .map(|((at, origin), stride)| (at - origin) as usize * stride)
                .sum()
        };
        let (from_start, to_start) = (start(&place.origin, &from), start(&self.wanted.origin, &to));
        let out = &mut *self.out;
        let copied = each_index(&ranges, |index| {
            let offset = |strides: &[usize]| -> usize {
                index
                    .iter()
                    .zip(strides)
                    .map(|(i, stride)| *i as usize * stride)
                    .sum()
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
