//! The slabs of a view, from front to back.

use super::shear::{Frame, Shear};
use super::slices::between;
use super::table::SlabClassify;
use super::{BufferSlice, ShearWarp};
use crate::lanes::COUNT;

/// What lies between two planes.
pub(super) struct Slab {
    /// The slices of its planes, which may lie between those of the volume.
    pub low: f64,
    pub high: f64,
    /// Where scalars are taken.
    pub front: Plane,
    pub back: Plane,
    /// Its place among the slabs of runs.
    pub of_runs: usize,
    /// The coordinates between which rays are in the box from plane to plane, and at all.
    pub whole: [f64; 2],
    pub any: [f64; 2],
}

/// A plane that scalars are taken in.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub slice: f64,
    /// The slices of voxels before and after it.
    pub between: (usize, usize, f32),
    /// Where the first pixel of rows is among voxels.
    pub start: f64,
    /// Where its buffer begins, but for pixels beside the box.
    pub buffer: isize,
}

/// The slabs from front to back, and how many scalars a row of the buffer slice has.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    clippy::cast_possible_wrap,
    reason = "places inside of images and volumes"
)]
pub(super) fn slabs(it: &ShearWarp<'_>, shear: &Shear, frame: &Frame) -> (Vec<Slab>, usize) {
    let per_slice = f64::from(it.slices_per_voxel);
    let is_post = it.table.classify == SlabClassify::Post;
    // Samples of slices lie in the middle of what they stand for.
    let offset = if is_post { -0.5 } else { 0.0 };
    let first = ((shear.low[2] - offset) * per_slice).floor() as i64;
    let last = ((shear.high[2] - offset) * per_slice).ceil() as i64;
    let dims = it.slices.dims;
    let [low, high] = [shear.low[0], shear.high[0]];
    let of_slice = ((high - low) * frame.scale).ceil() as usize + 3;
    let buffer = match it.buffer {
        BufferSlice::Slice => 2 * of_slice + 2 * COUNT,
        BufferSlice::Image => frame.width + 2 * COUNT,
    };
    let plane = |slice: f64, at: usize| Plane {
        slice,
        between: between(slice, dims[2]),
        start: frame.first[0] + slice * shear.slope[0],
        buffer: match it.buffer {
            BufferSlice::Image => 0,
            BufferSlice::Slice => {
                let before = low - slice * shear.slope[0] - frame.first[0];
                (at % 2 * of_slice) as isize - (before * frame.scale).floor() as isize
            }
        },
    };
    let slab = |order: usize, at: i64| {
        let [from, to] = [at, at + 1].map(|at| at as f64 / per_slice + offset);
        let middle = 0.5 * (from + to);
        let ends = [from, to].map(|slice| slice * shear.slope[0]);
        let [less, more] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let [front, back] = match (is_post, shear.is_rising) {
            (true, _) => [middle; 2],
            (_, true) => [from, to],
            _ => [to, from],
        };
        Slab {
            low: from,
            high: to,
            front: plane(front, order),
            back: plane(back, order + 1),
            of_runs: ((middle + 1.0).floor().max(0.0) as usize).min(dims[2]),
            whole: [low - less, high - more],
            any: [low - more, high - less],
        }
    };
    let count = (last - first).max(0);
    let slabs = (0..count)
        .enumerate()
        .map(|(order, i)| match shear.is_rising {
            true => slab(order, first + i),
            false => slab(order, last - 1 - i),
        });
    (slabs.collect(), buffer)
}
