//! What a frame did, as data.

use std::collections::BTreeMap;

use serde::Serialize;
use volgraph_graph::StateProgress;
use volgraph_report::Findings;

use crate::pool::PoolReport;

/// What one frame did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrameReport {
    /// All nodes in their order.
    pub nodes: Vec<NodeReport>,
    /// Memory after the frame.
    pub memory: PoolReport,
    /// Pipelines held.
    pub pipelines: usize,
    /// Warnings of what shaders did while they made what is shown, such as loads from outside of a texture: in this
    /// frame, or in the one whose results still hold.
    pub hazards: Findings,
    /// What people should know of what is shown: that a pool is too small for all that a picture needs, say.
    pub warnings: Findings,
    /// How far what is shown is, of nodes that make it from frame to frame: the picture gets better until all is there.
    pub progress: StateProgress,
}

/// What one node did in a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NodeReport {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Whether it ran, or what it wrote last still held.
    pub ran: bool,
    /// The variant that ran, where it has several.
    pub variant: Option<String>,
    /// The variants' times on the small view that chose among them, milliseconds.
    pub measured_ms: BTreeMap<String, f64>,
    /// Its time on the device, milliseconds; `None` where it did not run or the device cannot tell.
    pub gpu_ms: Option<f64>,
    /// What its result is in a few words, where it is made from frame to frame.
    pub about: Option<String>,
}

impl FrameReport {
    /// Everything that it warns of.
    #[must_use]
    pub fn all_warnings(&self) -> Findings {
        let mut all = self.hazards.clone();
        all.extend(self.warnings.clone());
        all
    }

    /// The names of the nodes that ran.
    #[must_use]
    pub fn ran(&self) -> Vec<&str> {
        self.nodes
            .iter()
            .filter(|node| node.ran)
            .map(|node| node.name.as_str())
            .collect()
    }
}
