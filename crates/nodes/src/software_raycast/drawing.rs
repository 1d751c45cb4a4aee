//! A picture that the software raycaster is to draw, as plain values.

use std::sync::Arc;

use volgraph_graph::{NodeContext, View};
use volgraph_optics::TransferFunction;
use volgraph_reference::{Background, Field, Look, Materials, Matter, Rays, Scene};
use volgraph_report::Finding;
use volgraph_software::{Attenuation, Classify, Raycast, Units};
use volgraph_volume::Volume;

use super::memory::SoftwareMemory;
use crate::raycast::data_value;
use crate::reference::{behind, rays};
use crate::source::volume::VolumeSource;
use crate::{placement, transfer_table};

/// A picture to be drawn on the processor.
#[derive(Clone, Debug)]
pub struct SoftwareDrawing {
    pub(super) rays: Rays,
    pub(super) volume: Arc<Volume>,
    pub(super) transfer: Arc<TransferFunction>,
    pub(super) classify: Classify,
    pub(super) background: Background,
    /// Voxels of the smallest spacing.
    pub(super) step: f64,
    pub(super) early_termination: f64,
    pub(super) leaps: bool,
    pub(super) table_size: u32,
}

/// The data values at 0 and 1 of a transfer function, and the volume's spacing.
pub(super) fn units(volume: &Volume, transfer: &TransferFunction) -> Units {
    let value = |at: f64| data_value(volume, transfer.domain(), at);
    Units {
        values: (value(0.0), value(1.0) - value(0.0)),
        spacing: volume.grid().min_spacing(),
    }
}

/// The volume at a node's port `volume`, shared.
pub(super) fn shared_volume(node: &NodeContext<'_>) -> Result<Arc<Volume>, Finding> {
    placement::volume(node, "volume")?;
    node.source::<VolumeSource>("volume")
        .map(|source| Arc::clone(&source.volume))
        .ok_or_else(|| node.error("missing-input", "its input `volume` is not a volume"))
}

/// The scene of a `software_raycast` node in a view, for the reference.
///
/// # Errors
/// `missing-input`; `not-covered` where what is behind is no background.
pub fn scene(node: &NodeContext<'_>, view: &View) -> Result<Scene, Finding> {
    let volume = placement::volume(node, "volume")?;
    let transfer = transfer_table::transfer(node, "transfer")?;
    let Units { values, spacing } = units(volume, &transfer);
    let matter = Matter::new(&transfer, values, spacing, &Materials::NONE);
    let unlit = Scene::unlit(rays(view), Field::new(volume), Look::unlit(matter));
    Ok(Scene {
        background: behind(node, view)?,
        ..unlit
    })
}

impl SoftwareDrawing {
    /// What a `software_raycast` node draws in a view.
    ///
    /// # Errors
    /// `missing-input`; `not-covered` where what is behind is no background.
    pub fn of(node: &NodeContext<'_>, view: &View) -> Result<Self, Finding> {
        let classify = match (node.text("classify"), node.text("attenuation")) {
            ("post", _) => Classify::Post,
            (_, "four_lines") => Classify::Integral1d(Attenuation::FourLines),
            _ => Classify::Integral1d(Attenuation::Exact),
        };
        Ok(Self {
            rays: rays(view),
            volume: shared_volume(node)?,
            transfer: transfer_table::transfer(node, "transfer")?,
            classify,
            background: behind(node, view)?,
            step: node.float("step"),
            early_termination: node.float("early_termination"),
            leaps: node.text("traverse") != "uniform",
            table_size: node.uint("table_size"),
        })
    }

    /// Draws it: linear premultiplied colours in rows from the top.
    ///
    /// # Errors
    /// A volume that is too large, a table of another size than there may be.
    pub fn render(&self, memory: &SoftwareMemory) -> Result<Vec<[f32; 4]>, Finding> {
        let prepared = memory.prepare(self)?;
        #[expect(clippy::cast_possible_truncation, reason = "walks are in f32")]
        let raycast = Raycast {
            placement: self.volume.grid(),
            voxels: &prepared.voxels,
            tables: &prepared.tables,
            empty: prepared.empty.as_deref(),
            step_world: self.step_world() as f32,
            early_termination: self.early_termination as f32,
        };
        Ok(raycast.render(&self.rays, &prepared.behind))
    }

    pub(super) fn step_world(&self) -> f64 {
        self.step * self.volume.grid().min_spacing()
    }
}
