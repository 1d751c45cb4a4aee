//! A picture that the software raycaster is to draw, as plain values.

use std::sync::Arc;

use volgraph_graph::{NodeContext, View};
use volgraph_optics::{Material, TransferFunction};
use volgraph_reference::{
    Background, Field, Lamp, Look, Materials, Matter, Rays, Scene, Tone, Window,
};
use volgraph_report::Finding;
use volgraph_software::{
    Attenuation, Classify, Extremum, Isosurface, Projection, Raycast, Refinement, Units,
};
use volgraph_volume::Volume;

use super::memory::{Prepared, SoftwareMemory};
use crate::raycast::data_value;
use crate::reference::{behind, choice_of, own_look, rays};
use crate::source::volume::VolumeSource;
use crate::{placement, transfer_table};

/// A picture to be drawn on the processor.
#[derive(Clone, Debug)]
pub struct SoftwareDrawing {
    pub(super) rays: Rays,
    pub(super) volume: Arc<Volume>,
    pub(super) background: Background,
    /// Voxels of the smallest spacing.
    pub(super) step: f64,
    pub(super) leaps: bool,
    pub(super) shows: Shows,
}

/// What a ray shows.
#[derive(Clone, Debug)]
pub(super) enum Shows {
    Matter(MatterDrawing),
    Projection {
        is_largest: bool,
        of_samples: bool,
        window: Window,
        color: [f64; 3],
    },
    Isosurface {
        level: f64,
        is_linear: bool,
        has_faces: bool,
        is_solid_below: bool,
        color: [f64; 3],
        light: Option<(Vec<Lamp>, Material)>,
    },
}

/// Emission and absorption.
#[derive(Clone, Debug)]
pub(super) struct MatterDrawing {
    pub(super) transfer: Arc<TransferFunction>,
    pub(super) classify: Classify,
    pub(super) early_termination: f64,
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

/// The scene of unlit emission and absorption of a whole volume in a view, for the reference.
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

/// What a node shows that is not emission and absorption: of a `software_raycast`, or of a `raycast` that it covers.
pub(super) fn scalar_shows(node: &NodeContext<'_>) -> Result<Option<Shows>, Finding> {
    let technique = choice_of(node, "technique");
    if technique == "dvr" {
        return Ok(None);
    }
    let look = own_look(node)?;
    if technique != "isosurface" {
        let Tone::Window(window, color) = look.tone else {
            let message = "the software raycaster does not draw a `tone` by a transfer function";
            return Err(node
                .error("not-covered", message)
                .help("choose the slot `tone` \"window\""));
        };
        return Ok(Some(Shows::Projection {
            is_largest: technique == "mip",
            of_samples: node.text("extremum") == "samples",
            window,
            color,
        }));
    }
    let layer = look.layers.first();
    Ok(Some(Shows::Isosurface {
        level: layer.map_or(0.0, |layer| layer.level),
        is_linear: node.text("refinement") == "linear",
        has_faces: node.text("cut_faces") != "open",
        is_solid_below: look.is_solid_below,
        color: layer.map_or([0.0; 3], |layer| layer.color),
        light: look.lamps.map(|lamps| (lamps, look.materials.default)),
    }))
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
        let shows = match scalar_shows(node)? {
            Some(shows) => shows,
            None => Shows::Matter(MatterDrawing {
                transfer: transfer_table::transfer(node, "transfer")?,
                classify,
                early_termination: node.float("early_termination"),
                table_size: node.uint("table_size"),
            }),
        };
        Ok(Self {
            rays: rays(view),
            volume: shared_volume(node)?,
            background: behind(node, view)?,
            step: node.float("step"),
            leaps: node.text("traverse") != "uniform",
            shows,
        })
    }

    /// Draws it: linear premultiplied colours in rows from the top.
    ///
    /// # Errors
    /// A volume that is too large, a table of another size than there may be.
    #[expect(clippy::cast_possible_truncation, reason = "walks are in f32")]
    pub fn render(&self, memory: &SoftwareMemory) -> Result<Vec<[f32; 4]>, Finding> {
        let Prepared {
            voxels,
            looks,
            ranges,
            behind,
        } = memory.prepare(self)?;
        let placement = self.volume.grid();
        let step = self.step_world() as f32;
        let single = |color: [f64; 3]| color.map(|channel| channel as f32);
        Ok(match (&self.shows, looks) {
            (Shows::Matter(matter), Some((tables, empty))) => Raycast {
                placement,
                voxels: &voxels,
                tables: &tables,
                empty: empty.as_deref(),
                step_world: step,
                early_termination: matter.early_termination as f32,
            }
            .render(&self.rays, &behind),
            (Shows::Matter(_), None) => behind.to_vec(),
            (
                Shows::Projection {
                    is_largest,
                    of_samples,
                    window,
                    color,
                },
                _,
            ) => Projection {
                placement,
                voxels: &voxels,
                ranges: ranges.as_deref(),
                is_largest: *is_largest,
                extremum: if *of_samples {
                    Extremum::Samples(step)
                } else {
                    Extremum::Field
                },
                window: *window,
                color: single(*color),
            }
            .render(&self.rays, &behind),
            (
                Shows::Isosurface {
                    level,
                    is_linear,
                    has_faces,
                    is_solid_below,
                    color,
                    light,
                },
                _,
            ) => {
                let (low, high) = placement::data_range(&*self.volume);
                Isosurface {
                    placement,
                    voxels: &voxels,
                    ranges: ranges.as_deref(),
                    level: *level,
                    value_range: high - low,
                    refinement: if *is_linear {
                        Refinement::Linear(step)
                    } else {
                        Refinement::Cubic
                    },
                    has_faces: *has_faces,
                    is_solid_below: *is_solid_below,
                    color: single(*color),
                    light: light
                        .as_ref()
                        .map(|(lamps, material)| (lamps.as_slice(), *material)),
                }
                .render(&self.rays, &behind)
            }
        })
    }

    pub(super) fn step_world(&self) -> f64 {
        self.step * self.volume.grid().min_spacing()
    }
}
