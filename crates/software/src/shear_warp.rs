//! Shear-warp of parallel rays (Lacroute and Levoy 1994), with pre-integrated slabs (Schulze, Kraus, Lang and Ertl 2003).
//!
//! The way of the data: a [`Shear`] takes the volume's axis that the view runs along most, and the shift of its slices that
//! makes all rays run along that axis. [`Slices`] are the voxels in that order, [`Runs`] the lengths of their rows in
//! which something may be seen, a [`SlabTable`] what a slab between two slices shows. Each row of the intermediate image,
//! which lies along the volume's own axes, goes through all slabs from front to back (`scanline`), rows on all cores;
//! then the picture is read out of it (`warp`). No pixel depends on how many cores there are.
//!
//! What is kept of the raycast's conventions: the box spans whole voxels, clamped in the outer half voxel. A slab that the
//! box or the eye's plane cuts is as long as its ray in it, by the paper's correction of opacity and colour. What cannot be
//! kept: rays are those of the intermediate image, and the picture is bilinear between them.

mod rows;
mod runs;
mod scanline;
mod shear;
mod slab;
mod slices;
mod table;
mod warp;

use rayon::prelude::*;
use volgraph_reference::Rays;
use volgraph_volume::Grid;

use crate::lanes::{Lanes, Portable, Work, with_lanes};

pub use self::runs::{Hidden, Runs};
use self::scanline::Scan;
pub use self::shear::{Frame, Shear};
pub use self::slices::Slices;
use self::slices::{Order, Voxel};
pub use self::table::{Correction, Lookup, SlabClassify, SlabTable};
use self::warp::warp;

/// Where scalars of the slice before are kept for the next slab (figure 6 of the paper). The picture is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BufferSlice {
    /// Two slices of the size of the volume's.
    Slice,
    /// One of the size of the intermediate image.
    Image,
}

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct ShearWarp<'a> {
    /// Where the volume is.
    pub placement: &'a Grid,
    /// Its voxels in the order of the view's main axis.
    pub slices: &'a Slices,
    /// What slabs show, of the length that they have.
    pub table: &'a SlabTable,
    /// What need not be looked at; all is where there are none.
    pub runs: Option<&'a Runs>,
    /// Pixels of the intermediate image for each voxel, along both axes.
    pub scale: f64,
    /// Slabs for each slice of the volume.
    pub slices_per_voxel: u32,
    /// A pixel ends where less than this share of the light behind could still reach the eye.
    pub early_termination: f32,
    /// Where scalars are kept.
    pub buffer: BufferSlice,
}

struct Picture<'a> {
    it: &'a ShearWarp<'a>,
    rays: &'a Rays,
    behind: &'a [[f32; 4]],
}

impl Work for Picture<'_> {
    type Output = Vec<[f32; 4]>;
    fn with<L: Lanes>(self, lanes: L) -> Self::Output {
        match &self.it.slices.order {
            Order::Bytes(values) => self.draw(lanes, values),
            Order::Shorts(values) => self.draw(lanes, values),
            Order::Floats(values) => self.draw(lanes, values),
        }
    }
}

impl Picture<'_> {
    fn draw<L: Lanes, T: Voxel>(&self, lanes: L, values: &[T]) -> Vec<[f32; 4]> {
        let it = self.it;
        let shear = Shear::along(it.placement, self.rays, it.slices.axis);
        let frame = Frame::new(&shear, it.scale);
        let scan = Scan::new(lanes, it, &shear, &frame, values);
        let mut image = vec![[0.0; 4]; frame.width * frame.height];
        let lines = image.par_chunks_exact_mut(frame.width).enumerate();
        lines.for_each_init(
            || scan.state(),
            |state, (line, pixels)| scan.line(state, line, pixels),
        );
        warp(&image, &frame, &shear, self.rays, self.behind)
    }
}

impl ShearWarp<'_> {
    /// The picture of these parallel rays, in rows from the top: linear premultiplied colours over those behind (over
    /// nothing where there are none).
    #[must_use]
    pub fn render(&self, rays: &Rays, behind: &[[f32; 4]]) -> Vec<[f32; 4]> {
        with_lanes(Picture {
            it: self,
            rays,
            behind,
        })
    }

    /// The same without the machine's own instructions: to the same bits, and slower.
    #[must_use]
    pub fn render_portable(&self, rays: &Rays, behind: &[[f32; 4]]) -> Vec<[f32; 4]> {
        Picture {
            it: self,
            rays,
            behind,
        }
        .with(Portable)
    }
}
