//! The voxels as renderers want them: what a trilinear sample needs lies in few words.
//!
//! Bytes: the four voxels of a cell's face across z in one word, so that a sample is two loads (four times the volume's own
//! memory). Two bytes: the two voxels of an edge along x in one word, four loads (twice). Others: floats, eight loads. At
//! the far faces voxels are repeated, so that no load has to look where it is.

mod corners;

use glam::DVec3;
use rayon::prelude::*;
use volgraph_volume::{ScalarType, Volume, Voxels};

use crate::SoftwareError;
use crate::lanes::{Lanes, three};

pub(crate) use self::corners::Corners;

/// Voxels for trilinear samples. A raw scalar is a data value minus [`offset`](Self::offset).
#[derive(Clone, Debug)]
pub struct VoxelGrid {
    pub(crate) dims: [u32; 3],
    pub(crate) cells: Cells,
    /// The data value of the raw scalar 0.
    pub offset: f64,
}

#[derive(Clone, Debug)]
pub(crate) enum Cells {
    Faces(Faces),
    Edges(Edges),
    Singles(Singles),
}

/// Words and the steps to the next one along y and z.
#[derive(Clone, Debug)]
pub(crate) struct Words {
    words: Vec<u32>,
    row: i32,
    layer: i32,
    last: [f32; 3],
}

#[derive(Clone, Debug)]
pub(crate) struct Faces(Words);
#[derive(Clone, Debug)]
pub(crate) struct Edges(Words);
#[derive(Clone, Debug)]
pub(crate) struct Singles(Words);

/// Samples at points of index space, which are clamped to the voxels' centres.
pub(crate) trait Sampled: Sync {
    fn sample<L: Lanes>(&self, l: L, at: [L::F; 3]) -> L::F;
}

impl VoxelGrid {
    /// Whether there can be one of a volume.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn check(volume: &Volume) -> Result<(), SoftwareError> {
        let dims = volume.grid().dims;
        let more = dims.iter().map(|n| u64::from(*n) + 1);
        if more.fold(1, u64::saturating_mul) < 1 << 31 {
            Ok(())
        } else {
            Err(SoftwareError::TooLarge { dims })
        }
    }

    /// The voxels of a volume.
    ///
    /// # Errors
    /// [`SoftwareError::TooLarge`] where places in it are no 32-bit numbers.
    pub fn new(volume: &Volume) -> Result<Self, SoftwareError> {
        Self::check(volume)?;
        let dims = volume.grid().dims;
        let voxels = volume.voxels();
        let (cells, offset) = match (voxels, voxels.scalar_type()) {
            (Voxels::U8(values), _) => (faces(dims, |at| u32::from(values[at])), 0.0),
            (Voxels::I8(values), _) => (
                faces(dims, |at| u32::from(values[at].cast_unsigned() ^ 0x80)),
                -128.0,
            ),
            (Voxels::U16(values), _) => (edges(dims, |at| u32::from(values[at])), 0.0),
            (Voxels::I16(values), _) => (
                edges(dims, |at| u32::from(values[at].cast_unsigned() ^ 0x8000)),
                -32768.0,
            ),
            (_, ty) => {
                let (low, high) = volume.statistics().range().unwrap_or((0.0, 0.0));
                // Data so far from 0 would lose digits in f32.
                let is_far = low.abs().max(high.abs()) > 16.0 * (high - low);
                let offset = if is_far || ty != ScalarType::F32 {
                    low
                } else {
                    0.0
                };
                #[expect(clippy::cast_possible_truncation, reason = "samples are f32")]
                let value = |at| (volume.drawn(voxels.get(at)) - offset) as f32;
                (singles(dims, |at| value(at).to_bits()), offset)
            }
        };
        Ok(Self {
            dims,
            cells,
            offset,
        })
    }
}

/// Words for each voxel, with so many more behind the last one along each axis.
fn words(dims: [u32; 3], more: [u32; 3], word: impl Fn([usize; 3]) -> u32 + Sync) -> Words {
    let [nx, ny, nz] = std::array::from_fn(|axis| (dims[axis] + more[axis]) as usize);
    let mut words = vec![0; nx * ny * nz];
    let layers = words.par_chunks_exact_mut(nx * ny).enumerate();
    layers.for_each(|(z, layer)| {
        for (y, row) in layer.chunks_exact_mut(nx).enumerate() {
            for (x, to) in row.iter_mut().enumerate() {
                *to = word([x, y, z]);
            }
        }
    });
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_precision_loss,
        reason = "there are less than 2^31"
    )]
    Words {
        words,
        row: nx as i32,
        layer: (nx * ny) as i32,
        last: dims.map(|n| (n - 1) as f32),
    }
}

/// The place of a voxel, which is clamped to the grid.
fn voxel(dims: [u32; 3]) -> impl Fn([usize; 3]) -> usize {
    let [nx, ny, nz] = dims.map(|n| n as usize);
    move |[x, y, z]| (z.min(nz - 1) * ny + y.min(ny - 1)) * nx + x.min(nx - 1)
}

fn faces(dims: [u32; 3], value: impl Fn(usize) -> u32 + Sync) -> Cells {
    let place = voxel(dims);
    let at = |x, y, z| value(place([x, y, z]));
    Cells::Faces(Faces(words(dims, [0, 0, 1], |[x, y, z]| {
        at(x, y, z) | at(x + 1, y, z) << 8 | at(x, y + 1, z) << 16 | at(x + 1, y + 1, z) << 24
    })))
}

fn edges(dims: [u32; 3], value: impl Fn(usize) -> u32 + Sync) -> Cells {
    let place = voxel(dims);
    let at = |x, y, z| value(place([x, y, z]));
    Cells::Edges(Edges(words(dims, [0, 1, 1], |[x, y, z]| {
        at(x, y, z) | at(x + 1, y, z) << 16
    })))
}

fn singles(dims: [u32; 3], value: impl Fn(usize) -> u32 + Sync) -> Cells {
    let place = voxel(dims);
    Cells::Singles(Singles(words(dims, [1, 1, 1], |at| value(place(at)))))
}

impl Words {
    /// The place of the cell that a point is in, and the point's place inside.
    #[inline(always)]
    fn cell<L: Lanes>(&self, l: L, at: [L::F; 3]) -> (L::I, [L::F; 3]) {
        let zero = l.splat(0.0);
        let inside = three(
            #[inline(always)]
            |axis| l.clamp(at[axis], zero, l.splat(self.last[axis])),
        );
        let [x, y, z] = three(
            #[inline(always)]
            |axis| l.truncated(inside[axis]),
        );
        let parts = three(
            #[inline(always)]
            |axis| l.sub(inside[axis], l.float([x, y, z][axis])),
        );
        let row = l.add_whole(l.mul_whole(y, l.whole(self.row)), x);
        (l.add_whole(l.mul_whole(z, l.whole(self.layer)), row), parts)
    }

    #[inline(always)]
    fn load<L: Lanes>(&self, l: L, at: L::I, more: i32) -> L::I {
        l.gather(&self.words, l.add_whole(at, l.whole(more)))
    }
}

impl Sampled for Faces {
    #[inline(always)]
    fn sample<L: Lanes>(&self, l: L, at: [L::F; 3]) -> L::F {
        let (cell, [u, v, w]) = self.0.cell(l, at);
        let near = Self::face(l, self.0.load(l, cell, 0), u, v);
        let far = Self::face(l, self.0.load(l, cell, self.0.layer), u, v);
        l.mix(near, far, w)
    }
}

impl Faces {
    /// Bilinear between the voxels of a word.
    #[inline(always)]
    fn face<L: Lanes>(l: L, word: L::I, u: L::F, v: L::F) -> L::F {
        let low = l.mix(l.byte::<0>(word), l.byte::<8>(word), u);
        l.mix(low, l.mix(l.byte::<16>(word), l.byte::<24>(word), u), v)
    }
}

impl Sampled for Edges {
    #[inline(always)]
    fn sample<L: Lanes>(&self, l: L, at: [L::F; 3]) -> L::F {
        let (cell, [u, v, w]) = self.0.cell(l, at);
        let (row, layer) = (self.0.row, self.0.layer);
        let near = l.mix(self.edge(l, cell, 0, u), self.edge(l, cell, row, u), v);
        let far = [layer, layer + row];
        let far = l.mix(
            self.edge(l, cell, far[0], u),
            self.edge(l, cell, far[1], u),
            v,
        );
        l.mix(near, far, w)
    }
}

impl Edges {
    /// Linear between the voxels of the word so many places on.
    #[inline(always)]
    fn edge<L: Lanes>(&self, l: L, cell: L::I, more: i32, u: L::F) -> L::F {
        let word = self.0.load(l, cell, more);
        l.mix(l.half::<0>(word), l.half::<16>(word), u)
    }
}

impl Sampled for Singles {
    #[inline(always)]
    fn sample<L: Lanes>(&self, l: L, at: [L::F; 3]) -> L::F {
        let (cell, [u, v, w]) = self.0.cell(l, at);
        let (row, layer) = (self.0.row, self.0.layer);
        let near = l.mix(self.edge(l, cell, 0, u), self.edge(l, cell, row, u), v);
        let far = [layer, layer + row];
        let far = l.mix(
            self.edge(l, cell, far[0], u),
            self.edge(l, cell, far[1], u),
            v,
        );
        l.mix(near, far, w)
    }
}

impl Singles {
    /// Linear between the voxel so many places on and the next one along x.
    #[inline(always)]
    fn edge<L: Lanes>(&self, l: L, cell: L::I, more: i32, u: L::F) -> L::F {
        let a = l.of_bits(self.0.load(l, cell, more));
        let b = l.of_bits(self.0.load(l, cell, more + 1));
        l.mix(a, b, u)
    }
}

impl VoxelGrid {
    /// The raw scalar at a point of index space.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "samples are f32")]
    pub fn sample(&self, at: DVec3) -> f32 {
        use crate::lanes::Portable;
        let at = at.to_array().map(|at| Portable.splat(at as f32));
        match &self.cells {
            Cells::Faces(cells) => cells.sample(Portable, at)[0],
            Cells::Edges(cells) => cells.sample(Portable, at)[0],
            Cells::Singles(cells) => cells.sample(Portable, at)[0],
        }
    }
}
