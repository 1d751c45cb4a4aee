//! A picture that shear-warp is to draw, as plain values.

use std::sync::Arc;

use volgraph_graph::{NodeContext, View};
use volgraph_optics::TransferFunction;
use volgraph_reference::{Background, Rays};
use volgraph_report::Finding;
use volgraph_software::Units;
use volgraph_software::shear_warp::{
    BufferSlice, Correction, Lookup, Shear, ShearWarp, SlabClassify,
};
use volgraph_volume::Volume;

use super::memory::ShearMemory;
use crate::raycast::data_value;
use crate::reference::{behind, rays};
use crate::source::volume::VolumeSource;
use crate::{placement, transfer_table};

/// A picture to be drawn on the processor.
#[derive(Clone, Debug)]
pub struct ShearDrawing {
    pub(super) rays: Rays,
    pub(super) volume: Arc<Volume>,
    pub(super) transfer: Arc<TransferFunction>,
    pub(super) background: Background,
    pub(super) classify: SlabClassify,
    pub(super) lookup: Lookup,
    pub(super) correction: Correction,
    pub(super) table_size: u32,
    pub(super) has_runs: bool,
    slices_per_voxel: u32,
    scale: f64,
    early_termination: f64,
    buffer: BufferSlice,
}

impl ShearDrawing {
    /// What a `shear_warp` node draws in a view.
    ///
    /// # Errors
    /// `perspective` where rays are not parallel; `missing-input`; `not-covered` where what is behind is no background.
    pub fn of(node: &NodeContext<'_>, view: &View) -> Result<Self, Finding> {
        let rays = rays(view);
        if !rays.is_orthographic {
            let message = "it draws parallel rays alone, and the camera is a perspective one";
            return Err(node.error("perspective", message).help(
                "give the camera `projection: orthographic`, or draw by a `software_raycast`",
            ));
        }
        placement::volume(node, "volume")?;
        let volume = node
            .source::<VolumeSource>("volume")
            .map(|source| Arc::clone(&source.volume))
            .ok_or_else(|| node.error("missing-input", "its input `volume` is not a volume"))?;
        Ok(Self {
            rays,
            volume,
            transfer: transfer_table::transfer(node, "transfer")?,
            background: behind(node, view)?,
            classify: match node.text("slab_classify") {
                "post" => SlabClassify::Post,
                _ => SlabClassify::Preintegrated,
            },
            lookup: match node.text("lookup") {
                "nearest" => Lookup::Nearest,
                _ => Lookup::Bilinear,
            },
            correction: match node.text("correction") {
                "scaled" => Correction::Scaled,
                "none" => Correction::None,
                _ => Correction::Exact,
            },
            table_size: node.uint("table_size"),
            has_runs: node.text("run_lengths") != "none",
            slices_per_voxel: node.uint("slices_per_voxel"),
            scale: node.float("scale"),
            early_termination: node.float("early_termination"),
            buffer: match node.text("buffer_slice") {
                "image" => BufferSlice::Image,
                _ => BufferSlice::Slice,
            },
        })
    }

    /// Draws it: linear premultiplied colours in rows from the top.
    ///
    /// # Errors
    /// A table of another size than there may be.
    pub fn render(&self, memory: &ShearMemory) -> Result<Vec<[f32; 4]>, Finding> {
        let prepared = memory.prepare(self)?;
        #[expect(clippy::cast_possible_truncation, reason = "compositing is in f32")]
        let it = ShearWarp {
            placement: self.volume.grid(),
            slices: &prepared.slices,
            table: &prepared.table,
            runs: prepared.runs.as_deref(),
            scale: self.scale,
            slices_per_voxel: self.slices_per_voxel,
            early_termination: self.early_termination as f32,
            buffer: self.buffer,
        };
        Ok(it.render(&self.rays, &prepared.behind))
    }

    pub(super) fn units(&self) -> Units {
        let value = |at: f64| data_value(&*self.volume, self.transfer.domain(), at);
        Units {
            values: (value(0.0), value(1.0) - value(0.0)),
            spacing: self.volume.grid().min_spacing(),
        }
    }

    /// World lengths of a slab: along rays, and along the main axis.
    pub(super) fn slab_world(&self, axis: usize) -> [f64; 2] {
        let grid = self.volume.grid();
        let shear = Shear::along(grid, &self.rays, axis);
        [shear.world_per_slice, grid.spacing()[axis]]
            .map(|world| world / f64::from(self.slices_per_voxel))
    }
}
