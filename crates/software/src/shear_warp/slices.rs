//! Voxels in the order of a main axis: slices, rows in them, and voxels in rows, one after the other in memory.

use glam::DVec3;
use rayon::prelude::*;
use volgraph_volume::{Volume, Voxels};

use super::shear::row_axes;

/// The voxels of a volume in the order of one main axis. A raw scalar is a data value minus [`offset`](Self::offset).
#[derive(Clone, Debug)]
pub struct Slices {
    pub(super) order: Order,
    /// Voxels along rows, rows, slices.
    pub(super) dims: [usize; 3],
    /// The main axis.
    pub axis: usize,
    /// The data value of the raw scalar 0.
    pub offset: f64,
}

#[derive(Clone, Debug)]
pub(super) enum Order {
    Bytes(Vec<u8>),
    Shorts(Vec<u16>),
    Floats(Vec<f32>),
}

/// A raw scalar as it is stored.
pub(super) trait Voxel: Copy + Send + Sync {
    fn scalar(self) -> f32;
}

impl Voxel for u8 {
    #[inline(always)]
    fn scalar(self) -> f32 {
        f32::from(self)
    }
}

impl Voxel for u16 {
    #[inline(always)]
    fn scalar(self) -> f32 {
        f32::from(self)
    }
}

impl Voxel for f32 {
    #[inline(always)]
    fn scalar(self) -> f32 {
        self
    }
}

impl Slices {
    /// The voxels of a volume. One and two bytes stay so; others are floats. What is no number is [`Volume::drawn`].
    #[must_use]
    pub fn new(volume: &Volume, axis: usize) -> Self {
        let all = volume.grid().dims;
        let voxels = volume.voxels();
        let (order, offset) = match voxels {
            Voxels::U8(values) => (Order::Bytes(ordered(all, axis, |at| values[at])), 0.0),
            Voxels::I8(values) => {
                let value = |at: usize| values[at].cast_unsigned() ^ 0x80;
                (Order::Bytes(ordered(all, axis, value)), -128.0)
            }
            Voxels::U16(values) => (Order::Shorts(ordered(all, axis, |at| values[at])), 0.0),
            Voxels::I16(values) => {
                let value = |at: usize| values[at].cast_unsigned() ^ 0x8000;
                (Order::Shorts(ordered(all, axis, value)), -32768.0)
            }
            _ => {
                // Data far from 0 would lose digits in f32.
                let offset = volume.statistics().range().map_or(0.0, |(low, _)| low);
                #[expect(clippy::cast_possible_truncation, reason = "samples are f32")]
                let value = |at| (volume.drawn(voxels.get(at)) - offset) as f32;
                (Order::Floats(ordered(all, axis, value)), offset)
            }
        };
        let [i, j] = row_axes(axis);
        Self {
            order,
            dims: [i, j, axis].map(|axis| all[axis] as usize),
            axis,
            offset,
        }
    }

    /// The memory that they take, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.order {
            Order::Bytes(values) => values.len(),
            Order::Shorts(values) => 2 * values.len(),
            Order::Floats(values) => 4 * values.len(),
        }
    }
}

fn ordered<T: Copy + Default + Send>(
    dims: [u32; 3],
    axis: usize,
    value: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let [i, j] = row_axes(axis);
    let [nx, ny, _] = dims.map(|n| n as usize);
    let strides = [1, nx, nx * ny];
    let [ni, nj, nk] = [i, j, axis].map(|axis| dims[axis] as usize);
    let mut values = vec![T::default(); ni * nj * nk];
    let slices = values.par_chunks_exact_mut(ni * nj).enumerate();
    slices.for_each(|(k, slice)| {
        for (row, to) in slice.chunks_exact_mut(ni).enumerate() {
            let start = k * strides[axis] + row * strides[j];
            for (at, to) in to.iter_mut().enumerate() {
                *to = value(start + at * strides[i]);
            }
        }
    });
    values
}

/// A coordinate among so many voxels: the one before it, the one after it, and how far it is between; clamped.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "clamped to voxels"
)]
pub(super) fn between(at: f64, count: usize) -> (usize, usize, f32) {
    let last = count - 1;
    let at = at.clamp(0.0, last as f64);
    let before = at as usize;
    (before, (before + 1).min(last), (at - before as f64) as f32)
}

/// The trilinear scalar at a point: along rows, across, along the main axis.
pub(super) fn trilinear<T: Voxel>(values: &[T], dims: [usize; 3], at: DVec3) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|axis| between(at[axis], dims[axis]));
    let mix = |a: f32, b: f32, share: f32| (b - a) * share + a;
    let slice = |k: usize| {
        let row = |j: usize| {
            let start = (k * dims[1] + j) * dims[0];
            mix(
                values[start + x.0].scalar(),
                values[start + x.1].scalar(),
                x.2,
            )
        };
        mix(row(y.0), row(y.1), y.2)
    };
    mix(slice(z.0), slice(z.1), z.2)
}
