//! The 2D pre-integrated table: the scalars at a segment's two ends in, the segment's colour and depth out
//! (Röttger, Kraus, Ertl 2000; Engel, Kraus, Ertl 2001), with the attenuation inside the segment.
//!
//! The way of the data: [`cells`] integrates the transfer function once over each of the `n - 1` cells
//! between neighbouring entries. An entry with `d = |front - back|` is then a window of `d` cells, each of
//! length `L / d`. Compositing is associative but has no inverse, so all windows of one `d` come from running
//! composites forward and backward inside blocks of `d` cells: a window is the tail of one block and the head
//! of the next (van Herk 1992, Gil and Werman 1993). No division, no cancellation, `O(n)` for each `d`.
//! The values of one `d` do not depend on any other, so the number of threads changes nothing.
//!
//! [`lit`] has the tables for materials and for light that changes along the segment; they are other composites of
//! the same windows. [`by_length`] has the table for all lengths, of the same windows again.

mod by_length;
mod cells;
mod flat;
mod integral;
mod lit;
mod piece;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

pub use self::by_length::PreintegratedTable3d;
use self::cells::Cells;
pub use self::flat::{PreintegrationPiece, PreintegrationPieces};
pub use self::integral::IntegralTable;
pub use self::lit::{PreintegratedMaterial, PreintegratedMoments};
use crate::post::node;
use crate::{OpticsError, TransferFunction, opacity_from_extinction};

/// Colour and optical depth of segments of one length, for each pair of scalars at their ends.
///
/// Each entry agrees with a float64 quadrature within 1e-6 in colours of 0 to 1 (and in proportion to larger ones), and
/// in its depth within 1e-6 of the larger of 1 and the depth: at any number of entries, for segments of up to 32
/// reference lengths, across steps, narrow peaks and where the extinction goes from nothing to opaque between two
/// entries. What lies between entries is the reader's to interpolate.
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
        check(n, segment_length)?;
        Ok(build(self, n, segment_length))
    }
}

/// Whether there can be a table of so many entries a side for segments of so many reference lengths.
fn check(asked: u32, segment_length: f64) -> Result<(), OpticsError> {
    let (min, max) = (PreintegratedTable::MIN_SIZE, PreintegratedTable::MAX_SIZE);
    if !(min..=max).contains(&asked) {
        let table = "pre-integrated";
        return Err(OpticsError::TableSize {
            table,
            asked,
            min,
            max,
        });
    }
    if !(segment_length.is_finite() && segment_length > 0.0) {
        return Err(OpticsError::SegmentLength(segment_length));
    }
    Ok(())
}

/// What stretches of scalars that follow each other come to together. Associative; there is no inverse.
trait Composite: Copy + Send {
    /// A stretch of no length.
    const EMPTY: Self;

    /// `self` and behind it, at higher scalars, `next`.
    #[must_use]
    fn then(self, next: Self) -> Self;
}

/// A stretch of scalars, run through in both directions: what it emits in `N` channels.
#[derive(Clone, Copy, Debug)]
struct Stretch<const N: usize> {
    /// Colour towards the low end, for a segment that starts there.
    rising: [f64; N],
    /// Colour towards the high end, for a segment that starts there.
    falling: [f64; N],
    depth: f64,
    transmittance: f64,
}

impl<const N: usize> Composite for Stretch<N> {
    const EMPTY: Self = Self {
        rising: [0.0; N],
        falling: [0.0; N],
        depth: 0.0,
        transmittance: 1.0,
    };

    fn then(self, next: Self) -> Self {
        Self {
            rising: over(self.rising, self.transmittance, next.rising),
            falling: over(next.falling, next.transmittance, self.falling),
            depth: self.depth + next.depth,
            transmittance: self.transmittance * next.transmittance,
        }
    }
}

fn over<const N: usize>(front: [f64; N], transmittance: f64, back: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| front[i] + transmittance * back[i])
}

/// Rising (front `i`) and falling (front `i + d`).
type Pair = ([f32; 4], [f32; 4]);

fn build(transfer: &TransferFunction, n: u32, segment_length: f64) -> PreintegratedTable {
    let cells = Cells::integrate(transfer, n, segment_length, 0.0);
    let constant = |i| {
        let s = node(transfer.range(), n, i);
        let depth = transfer.extinction(s) * segment_length;
        let opacity = opacity_from_extinction(depth);
        packed(transfer.color(s).map(|c| c * opacity), depth)
    };
    let stretch = |cell, cells_of_segment| cells.stretch(cell, segment_length / cells_of_segment);
    let pack = |w: Stretch<3>, _| (packed(w.rising, w.depth), packed(w.falling, w.depth));
    PreintegratedTable {
        size: n,
        entries: tabulate(n, constant, stretch, pack),
    }
}

/// All pairs of `n` scalars, `[front + n * back]`: `constant` is the entry from a scalar to itself, `stretch` a cell
/// where a segment has so many, and `pack` makes entries of a window of so many cells.
fn tabulate<S: Composite>(
    n: u32,
    constant: impl Fn(u32) -> [f32; 4] + Sync,
    stretch: impl Fn(usize, f64) -> S + Sync,
    pack: impl Fn(S, f64) -> Pair + Sync,
) -> Vec<[f32; 4]> {
    let size = n as usize;
    let diagonals: Vec<Vec<Pair>> = (0..size)
        .into_par_iter()
        .map(|d| match d {
            0 => (0..n).map(&constant).map(|entry| (entry, entry)).collect(),
            _ => {
                let stretches = (0..size - 1).map(|cell| stretch(cell, d as f64)).collect();
                diagonal(stretches, d, |window| pack(window, d as f64))
            }
        })
        .collect();
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
    entries
}

/// All windows of `d` cells.
fn diagonal<S: Composite>(stretches: Vec<S>, d: usize, pack: impl Fn(S) -> Pair) -> Vec<Pair> {
    let cells = stretches.len();
    // Composite from the start of the block of d cells up to and with this one; and from this one to its end.
    let (mut heads, mut tails) = (stretches.clone(), stretches);
    for i in 1..cells {
        if i % d != 0 {
            heads[i] = heads[i - 1].then(heads[i]);
        }
    }
    for i in (1..cells).rev() {
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
    (0..=cells - d).map(window).map(pack).collect()
}

fn packed([r, g, b]: [f64; 3], depth: f64) -> [f32; 4] {
    [r as f32, g as f32, b as f32, depth as f32]
}
