//! The 2D pre-integrated table: the scalars at a segment's two ends in, the segment's colour and depth out
//! (Röttger, Kraus, Ertl 2000; Engel, Kraus, Ertl 2001), with the attenuation inside the segment.
//!
//! The way of the data: [`cells`] integrates the transfer function once over each of the `n - 1` cells
//! between neighbouring entries. An entry with `d = |front - back|` is then a window of `d` cells, each of
//! length `L / d`. Compositing is associative but has no inverse, so all windows of one `d` come from running
//! composites forward and backward inside blocks of `d` cells: a window is the tail of one block and the head
//! of the next (van Herk 1992, Gil and Werman 1993). No division, no cancellation, `O(n)` for each `d`.
//! The values of one `d` do not depend on any other, so the number of threads changes nothing.

mod cells;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use self::cells::Cells;
use crate::post::node;
use crate::{OpticsError, TransferFunction, opacity_from_extinction};

/// Colour and optical depth of segments of one length, for each pair of scalars at their ends.
///
/// Against float64 quadrature, with colours of 0 to 1 and segments of up to 6 reference lengths, the error of an
/// entry's colour is below 1e-5 at 1024 entries a side and falls with the square of their number, also for narrow
/// peaks and across steps; the depth is right to f32's precision.
#[derive(Clone, Debug, PartialEq)]
pub struct PreintegratedTable {
    /// Entries a side, `n`; entry `i` stands for the scalar `lo + i / (n - 1) · (hi - lo)`.
    pub size: u32,
    /// `n × n` entries, front fastest: `[front + n * back]`. Linear RGB that the segment emits towards its
    /// front, premultiplied and attenuated by the segment itself; in the fourth place the segment's optical
    /// depth `τ` (its opacity is `1 - exp(-τ)`).
    pub entries: Vec<[f32; 4]>,
}

impl PreintegratedTable {
    /// Fewer entries than this are no table but a sketch.
    pub const MIN_SIZE: u32 = 64;
    /// A table of this size takes 256 MiB.
    pub const MAX_SIZE: u32 = 4096;

    /// The entry for a segment from entry `front` to entry `back`, both below `size`.
    #[must_use]
    pub fn entry(&self, front: u32, back: u32) -> Option<[f32; 4]> {
        let is_inside = front < self.size && back < self.size;
        let at = front as usize + self.size as usize * back as usize;
        self.entries.get(at).filter(|_| is_inside).copied()
    }
}

impl TransferFunction {
    /// The 2D pre-integrated table with `n` entries a side, [`PreintegratedTable::MIN_SIZE`] to
    /// [`PreintegratedTable::MAX_SIZE`] (1024 is usual), for segments of `segment_length` reference lengths.
    ///
    /// # Errors
    /// [`OpticsError::TableSize`], [`OpticsError::SegmentLength`].
    pub fn preintegrated_table(
        &self,
        n: u32,
        segment_length: f64,
    ) -> Result<PreintegratedTable, OpticsError> {
        let (min, max) = (PreintegratedTable::MIN_SIZE, PreintegratedTable::MAX_SIZE);
        if !(min..=max).contains(&n) {
            let table = "pre-integrated";
            return Err(OpticsError::TableSize {
                table,
                asked: n,
                min,
                max,
            });
        }
        if !(segment_length.is_finite() && segment_length > 0.0) {
            return Err(OpticsError::SegmentLength(segment_length));
        }
        Ok(build(self, n, segment_length))
    }
}

/// A stretch of scalars, run through in both directions.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    /// Colour towards the low end, for a segment that starts there.
    rising: [f64; 3],
    /// Colour towards the high end, for a segment that starts there.
    falling: [f64; 3],
    depth: f64,
    transmittance: f64,
}

impl Stretch {
    const EMPTY: Self = Self {
        rising: [0.0; 3],
        falling: [0.0; 3],
        depth: 0.0,
        transmittance: 1.0,
    };

    /// `self` and behind it, at higher scalars, `next`.
    fn then(self, next: Self) -> Self {
        Self {
            rising: over(self.rising, self.transmittance, next.rising),
            falling: over(next.falling, next.transmittance, self.falling),
            depth: self.depth + next.depth,
            transmittance: self.transmittance * next.transmittance,
        }
    }
}

fn over(front: [f64; 3], transmittance: f64, back: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| front[i] + transmittance * back[i])
}

/// One entry for each pair of neighbours `i`, `i + d`: rising (front `i`) and falling (front `i + d`).
type Diagonal = Vec<([f32; 4], [f32; 4])>;

fn build(transfer: &TransferFunction, n: u32, segment_length: f64) -> PreintegratedTable {
    let cells = Cells::integrate(transfer, n);
    let diagonals: Vec<Diagonal> = (0..n as usize)
        .into_par_iter()
        .map(|d| match d {
            0 => constants(transfer, n, segment_length),
            _ => diagonal(&cells, d, segment_length / d as f64),
        })
        .collect();
    let size = n as usize;
    let mut entries = vec![[0.0; 4]; size * size];
    entries
        .par_chunks_mut(size)
        .enumerate()
        .for_each(|(back, row)| {
            for (front, entry) in row.iter_mut().enumerate() {
                *entry = if front <= back {
                    diagonals[back - front][front].0
                } else {
                    diagonals[front - back][back].1
                };
            }
        });
    PreintegratedTable { size: n, entries }
}

fn constants(transfer: &TransferFunction, n: u32, segment_length: f64) -> Diagonal {
    let entry = |i| {
        let s = node(transfer.range(), n, i);
        let depth = transfer.extinction(s) * segment_length;
        let opacity = opacity_from_extinction(depth);
        packed(transfer.color(s).map(|c| c * opacity), depth)
    };
    (0..n).map(entry).map(|entry| (entry, entry)).collect()
}

/// All windows of `d` cells, each cell `cell_length` reference lengths long.
fn diagonal(cells: &Cells, d: usize, cell_length: f64) -> Diagonal {
    let stretches: Vec<Stretch> = (0..cells.len())
        .map(|cell| cells.stretch(cell, cell_length))
        .collect();
    // Composite from the start of the block of d cells up to and with this one; and from this one to its end.
    let (mut heads, mut tails) = (stretches.clone(), stretches);
    for i in 1..heads.len() {
        if i % d != 0 {
            heads[i] = heads[i - 1].then(heads[i]);
        }
    }
    for i in (1..tails.len()).rev() {
        if i % d != 0 {
            tails[i - 1] = tails[i - 1].then(tails[i]);
        }
    }
    let window = |start: usize| {
        let head = heads[start + d - 1];
        if start.is_multiple_of(d) {
            head
        } else {
            tails[start].then(head)
        }
    };
    (0..=cells.len() - d)
        .map(window)
        .map(|w| (packed(w.rising, w.depth), packed(w.falling, w.depth)))
        .collect()
}

fn packed([r, g, b]: [f64; 3], depth: f64) -> [f32; 4] {
    [r as f32, g as f32, b as f32, depth as f32]
}
