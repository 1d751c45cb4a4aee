//! What a graph's picture should be, as methods are held against it.

use serde::Serialize;
use volgraph_graph::{Plan, View};
use volgraph_nodes::reference::rays;
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_picture::Picture;
use volgraph_reference::Progress;
use volgraph_report::{Finding, Findings};

use super::accuracy::{Errors, core_pixels, errors};
use super::space::raycast_node;
use crate::truth::{Truth, TruthOptions};

/// The step of the truth that is drawn finely, in voxels.
pub const FINE_STEP: f64 = 1.0 / 32.0;

/// Where a truth comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TruthKind {
    /// The float64 reference.
    Reference,
    /// The same graph at a very fine step, in the device's f32.
    Fine,
}

/// What pictures are held against.
#[derive(Clone, Debug)]
pub struct Yardstick {
    /// What the picture should be.
    pub truth: Picture,
    /// Where that comes from.
    pub kind: TruthKind,
    /// Bound of the truth's own error, where it is known.
    pub bound: Option<f64>,
    /// Whether each pixel is a core pixel.
    pub core: Vec<bool>,
}

impl Yardstick {
    /// The float64 reference of a plan's picture.
    ///
    /// # Errors
    /// As [`Truth::of`]: `not-covered` where the reference does not compute what the graph draws.
    pub fn reference(
        plan: &Plan,
        view: &View,
        options: &TruthOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Findings> {
        let truth = Truth::of(plan, view, options, progress)?;
        let bound = truth.rendered.error.iter().copied().fold(0.0, f64::max);
        Ok(Self {
            truth: truth.picture()?,
            kind: TruthKind::Reference,
            bound: Some(bound),
            core: core(plan, view)?,
        })
    }

    /// A picture that was drawn finely enough to be taken as the truth.
    ///
    /// # Errors
    /// As [`raycast_node`].
    pub fn fine(plan: &Plan, view: &View, picture: Picture) -> Result<Self, Findings> {
        Ok(Self {
            truth: picture,
            kind: TruthKind::Fine,
            bound: None,
            core: core(plan, view)?,
        })
    }

    /// The errors of a picture.
    ///
    /// # Errors
    /// As [`errors`].
    pub fn errors(&self, picture: &Picture) -> Result<Errors, Finding> {
        errors(picture, &self.truth, &self.core)
    }
}

/// The core pixels of the raycast that draws a plan's picture.
fn core(plan: &Plan, view: &View) -> Result<Vec<bool>, Finding> {
    let node = plan.context(raycast_node(plan)?, view, None);
    let source = node.source::<VolumeSource>("volume").ok_or_else(|| {
        node.error("missing-input", "its input `volume` is not a volume")
            .help("connect a volume")
    })?;
    Ok(core_pixels(source.volume.grid(), &rays(view)))
}
