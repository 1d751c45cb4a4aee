//! What a graph's picture should be, as methods are held against it.

use serde::Serialize;
use volgraph_graph::{Plan, View};
use volgraph_nodes::reference::rays;
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_picture::Picture;
use volgraph_reference::Progress;
use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

use super::accuracy::{Errors, core_pixels, errors};
use super::measurement::{Method, Setting};
use super::space::raycast_node;
use crate::truth::{Truth, TruthOptions};

/// The step of the truth that is drawn finely, in voxels, where the longest ray is not too long for it.
const FINE_STEP: f64 = 1.0 / 32.0;

/// Where a truth comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TruthKind {
    /// The float64 reference.
    Reference,
    /// The same graph at a very fine step, in the device's f32.
    Fine,
}

/// Whether a truth failed for that alone that the reference does not compute what the graph draws.
#[must_use]
pub fn is_uncovered(findings: &Findings) -> bool {
    findings
        .sorted()
        .iter()
        .all(|finding| finding.code == "not-covered")
}

/// The shortest step in voxels that the raycast of a plan may have for the longest ray through its volume; with a margin
/// for rounding.
///
/// # Errors
/// As [`raycast_node`].
pub fn shortest_step(plan: &Plan) -> Result<f64, Finding> {
    let view = plan.view();
    let node = plan.context(raycast_node(plan)?, &view, None);
    let volume = volgraph_nodes::placement::volume(&node, "volume")?;
    Ok(1.001 * volgraph_nodes::raycast::shortest_step(volume.grid()))
}

/// The step of the truth that is drawn finely, in voxels.
///
/// # Errors
/// As [`raycast_node`].
pub fn fine_step(plan: &Plan) -> Result<f64, Finding> {
    Ok(FINE_STEP.max(shortest_step(plan)?))
}

/// The settings of a plan's raycast that stand for the truth where the reference does not compute it: a very fine step, to
/// the end of each ray, voxels in f32; those that it has.
///
/// # Errors
/// As [`raycast_node`].
pub fn fine_method(plan: &Plan) -> Result<Method, Finding> {
    let node = &plan.graph.nodes[raycast_node(plan)?];
    let settings = [
        ("step", ParamValue::Float(fine_step(plan)?)),
        ("early_termination", ParamValue::Float(0.0)),
        ("volume_storage", ParamValue::Text("r32float".to_owned())),
    ];
    let settings = settings.into_iter().filter(|(name, value)| {
        let mut specs = node.specs().into_iter();
        specs.any(|spec| spec.name == *name && spec.check(value).is_ok())
    });
    let settings = settings.map(|(name, value)| Setting {
        name: name.to_owned(),
        is_slot: false,
        value,
    });
    Ok(Method {
        settings: settings.collect(),
    })
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
