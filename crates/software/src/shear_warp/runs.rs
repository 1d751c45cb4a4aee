//! The classified volume, run-length encoded: where along rows something may be seen.
//!
//! Classes rather than opacities are encoded: a voxel is in one of the gaps between the scalars that absorb, or it is seen.
//! A slab shows nothing where all voxels that its scalars are made of are in one gap; then so are all scalars between.
//! So a run holds for pre-integrated slabs from any direction, and changes only with the intervals that absorb.

use rayon::prelude::*;
use volgraph_optics::{TransferFunction, union};

use super::slices::{Order, Slices, Voxel};
use super::table::{SlabClassify, SlabTable};
use crate::tables::Units;

/// Data values that may be seen, as a table shows them: open intervals, rising and apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Hidden {
    seen: Vec<(f64, f64)>,
}

impl Hidden {
    /// Of a transfer function in a table with so many entries a side: what is between two entries is of both.
    #[must_use]
    pub fn new(
        transfer: &TransferFunction,
        units: Units,
        classify: SlabClassify,
        size: u32,
    ) -> Self {
        let size = match classify {
            SlabClassify::Post => SlabTable::POST_SIZE,
            SlabClassify::Preintegrated => size,
        };
        // More than a cell, for rounding.
        let margin = 1.01 * SlabTable::cell(transfer, units, size);
        let value = |at: f64| units.values.0 + at * units.values.1;
        let widened = transfer
            .absorbing()
            .into_iter()
            .map(|(low, high)| (value(low) - margin, value(high) + margin));
        Self {
            seen: union(widened.collect()),
        }
    }

    /// The gap that a data value is in, from 1 on; [`SEEN`] in none.
    fn class(&self, value: f64) -> u8 {
        let below = self.seen.partition_point(|(_, high)| *high < value);
        if self.seen.get(below).is_some_and(|(low, _)| *low <= value) {
            return SEEN;
        }
        // Gaps that are too many to count may be seen.
        u8::try_from(below + 1).unwrap_or(SEEN)
    }
}

const SEEN: u8 = 0;

/// Runs of voxels in the rows of a volume, in the order of a main axis, about which a slab is not empty.
#[derive(Clone, Debug)]
pub struct Runs {
    /// From one before the first slice to the last one: the slab behind it; in each, rows.
    rows: usize,
    /// Where runs of each row begin.
    starts: Vec<u32>,
    runs: Vec<[u32; 2]>,
    /// Voxels in a row.
    length: usize,
}

impl Runs {
    /// Of voxels, of what is seen.
    #[must_use]
    pub fn new(slices: &Slices, hidden: &Hidden) -> Self {
        let class = |raw: f64| hidden.class(raw + slices.offset);
        match &slices.order {
            Order::Bytes(values) => {
                let table: Vec<u8> = (0..=u8::MAX).map(|it| class(f64::from(it))).collect();
                Self::encode(slices.dims, values, |it| table[usize::from(it)])
            }
            Order::Shorts(values) => {
                let table: Vec<u8> = (0..=u16::MAX).map(|it| class(f64::from(it))).collect();
                Self::encode(slices.dims, values, |it| table[usize::from(it)])
            }
            Order::Floats(values) => Self::encode(slices.dims, values, |it| class(f64::from(it))),
        }
    }

    fn encode<T: Voxel>(dims: [usize; 3], values: &[T], class: impl Fn(T) -> u8 + Sync) -> Self {
        let [length, rows, slices] = dims;
        let classified = |slice: usize| {
            let slice = &values[slice * length * rows..][..length * rows];
            slice.iter().map(|it| class(*it)).collect::<Vec<u8>>()
        };
        let slabs: Vec<(Vec<u32>, Vec<[u32; 2]>)> = (0..=slices)
            .into_par_iter()
            .map(|slab| {
                let mut pair = classified(slab.saturating_sub(1));
                if 0 < slab && slab < slices {
                    alike(&mut pair, &classified(slab));
                }
                encoded(&pair, length)
            })
            .collect();
        let mut starts = vec![0];
        let mut runs = Vec::new();
        for (ends, of_slab) in slabs {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "less than voxels of a volume in memory / 4"
            )]
            let base = runs.len() as u32;
            starts.extend(ends.into_iter().map(|end| base + end));
            runs.extend(of_slab);
        }
        Self {
            rows,
            starts,
            runs,
            length,
        }
    }

    /// The runs of a row in the slab before a slice (0 is that before the first one).
    pub(super) fn row(&self, slab: usize, row: usize) -> &[[u32; 2]] {
        let at = slab * self.rows + row;
        &self.runs[self.starts[at] as usize..self.starts[at + 1] as usize]
    }

    /// Voxels in a row.
    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// The share of voxels about which something may be seen.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a share")]
    pub fn seen_share(&self) -> f64 {
        let seen: u64 = self
            .runs
            .iter()
            .map(|[from, to]| u64::from(to - from))
            .sum();
        seen as f64 / ((self.starts.len() - 1) * self.length) as f64
    }

    /// The memory that they take, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        4 * self.starts.len() + 8 * self.runs.len()
    }
}

/// The class of both where it is one.
fn alike(classes: &mut [u8], others: &[u8]) {
    for (class, other) in classes.iter_mut().zip(others) {
        *class = if class == other { *class } else { SEEN };
    }
}

/// The ends of each row's runs, and the runs. From its front to its back a ray moves by one voxel at most along rows and
/// across them: from cell `x` it reads voxels `x - 1` to `x + 2`.
fn encoded(pair: &[u8], length: usize) -> (Vec<u32>, Vec<[u32; 2]>) {
    let rows = pair.len() / length;
    let row = |at: usize| &pair[at * length..][..length];
    let mut ends = Vec::with_capacity(rows);
    let mut runs = Vec::new();
    let mut near = vec![0; length];
    for y in 0..rows {
        near.copy_from_slice(row(y.saturating_sub(1)));
        for other in y..(y + 3).min(rows) {
            alike(&mut near, row(other));
        }
        let is_seen = |x: usize| {
            let class = near[x];
            let reach = &near[x.saturating_sub(1)..(x + 3).min(length)];
            class == SEEN || reach.iter().any(|other| *other != class)
        };
        let mut from = None;
        for x in 0..=length {
            let is_one = x < length && is_seen(x);
            match (from, is_one) {
                (None, true) => from = Some(x),
                (Some(start), false) => {
                    #[expect(clippy::cast_possible_truncation, reason = "voxels along an axis")]
                    runs.push([start as u32, x as u32]);
                    from = None;
                }
                _ => {}
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "runs of a slab")]
        ends.push(runs.len() as u32);
    }
    (ends, runs)
}
