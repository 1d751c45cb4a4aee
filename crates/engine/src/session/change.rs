//! What can change in a session, and what came of it, as data.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Duration;

use serde::Serialize;
use volgraph_gpu::FrameReport;
use volgraph_graph::CameraDesc;
use volgraph_picture::Picture;
use volgraph_report::Findings;

use crate::overrides::ParamOverride;
use crate::quality::Chosen;

/// A change to what a session draws.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// These files are not as they were. The graph and the shaders are looked at anew in any case; sources are read
    /// again where one of their files is named here.
    Files(BTreeSet<PathBuf>),
    /// Parameters, slots or sources' fields are set, each over what it was set to before.
    Set(Vec<ParamOverride>),
    /// The camera moves; what stays open is fitted to the volumes.
    Camera(CameraDesc),
    /// The output [`crate::LOOK`] shows another node's port (`node.port`), or there is none any more.
    Look(Option<String>),
    /// The picture has another width and height in pixels.
    Size([u32; 2]),
}

/// What came of a change that was taken.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Nothing that the picture depends on is different.
    Unchanged,
    /// A new picture was drawn.
    Drawn(Box<Drawn>),
}

/// A picture after a change.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// How it came about.
    pub report: ChangeReport,
}

/// A change that was not taken: picture, pipelines and memory of work are as they were.
#[derive(Clone, Debug)]
pub struct Refused {
    /// Everything wrong with it.
    pub findings: Findings,
    /// Whether exactly these findings have been told already: of the change before, or of the last change of files
    /// where none has been taken since.
    pub is_repeat: bool,
    /// Why the device was lost and made again meanwhile, if it was.
    pub device_remade: Option<String>,
}

/// What a change did and cost.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ChangeReport {
    /// The files that changed, and what each is to the picture.
    pub changed: Vec<ChangedFile>,
    /// The pipelines that were built: `node (entry point)`.
    pub pipelines_built: Vec<String>,
    /// Parameters that the shaders did not have before: `node.name = value`.
    pub params_added: Vec<String>,
    /// Parameters that the shaders no longer have: `node.name = value` as it was.
    pub params_dropped: Vec<String>,
    /// Values that were set for parameters which no shader has any longer; they are set again when it comes back.
    pub set_aside: Vec<String>,
    /// What was chosen for the graph's budget, where that is new.
    pub chosen: Option<Chosen>,
    /// What the user should know of sources that were read.
    pub warnings: Vec<String>,
    /// Why the device was lost and made again, if it was.
    pub device_remade: Option<String>,
    /// Time of each stage.
    pub stages: Stages,
    /// What the frame did.
    pub frame: FrameReport,
}

/// A file that changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChangedFile {
    /// The file.
    pub path: PathBuf,
    /// `graph`, `shader` or `source NAME`.
    pub role: String,
}

/// Milliseconds of the stages of a change, in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Stages {
    /// Reading the graph file and the sources that changed.
    pub read_ms: f64,
    /// Reading and linking shaders.
    pub link_ms: f64,
    /// Parsing and validating them.
    pub validate_ms: f64,
    /// All other phases of the plan.
    pub plan_ms: f64,
    /// Guarding shader modules and handing them to the device.
    pub module_ms: f64,
    /// The driver's building of pipelines.
    pub pipeline_ms: f64,
    /// Allocating, and recording once to prove it.
    pub allocate_ms: f64,
    /// The frame.
    pub draw_ms: f64,
    /// Reading the picture back and looking at it.
    pub read_back_ms: f64,
}

impl Stages {
    /// All of them together.
    #[must_use]
    pub fn total_ms(&self) -> f64 {
        self.own_ms() + self.pipeline_ms + self.draw_ms
    }

    /// volgraph's own share: all but the driver's building of pipelines and the frame.
    #[must_use]
    pub fn own_ms(&self) -> f64 {
        self.read_ms
            + self.link_ms
            + self.validate_ms
            + self.plan_ms
            + self.module_ms
            + self.allocate_ms
            + self.read_back_ms
    }
}

/// A duration in milliseconds.
pub(super) fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
