//! volgraph's methods beside other renderers, for a chart of speed against accuracy.

use serde::Serialize;
use volgraph_measure::timing::Summary;

use super::peers::{PeerJob, PeerWork};

/// A method of volgraph with its error and its time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerPoint {
    /// The harness's name of the volume.
    pub volume: String,
    /// What is drawn.
    pub work: PeerWork,
    /// The method: what is set.
    pub method: String,
    /// Its error in 8-bit steps over core pixels.
    pub error: Option<f64>,
    /// Milliseconds of its frames, of all turns.
    pub frame_ms: Summary,
}

impl PeerPoint {
    /// Whether the software raycaster draws it.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.method.contains("renderer=software")
    }
}

/// The jobs that a chart has beside those of the table, so that each renderer has a curve. Where a renderer's step is
/// fixed there is nothing to add.
pub const CHART_JOBS: [PeerJob; 11] = [
    job(PeerWork::Dvr, "vtk-gpu-egl", "composite", 2.0),
    job(PeerWork::Dvr, "vtk-gpu-egl", "composite", 0.25),
    job(PeerWork::Dvr, "vtk-fixedpoint", "composite", 2.0),
    job(PeerWork::Dvr, "vtk-fixedpoint", "composite", 0.25),
    job(PeerWork::Dvr, "vispy-egl", "translucent", 2.0),
    job(PeerWork::Dvr, "vispy-egl", "translucent", 0.25),
    job(PeerWork::Mip, "vtk-gpu-egl", "mip", 0.5),
    job(PeerWork::Mip, "vtk-gpu-egl", "mip", 0.25),
    job(PeerWork::Mip, "vtk-fixedpoint", "mip", 0.5),
    job(PeerWork::Mip, "vispy-egl", "mip", 0.5),
    job(PeerWork::Mip, "vispy-egl", "mip", 0.25),
];

const fn job(work: PeerWork, peer: &'static str, mode: &'static str, step: f64) -> PeerJob {
    PeerJob {
        work,
        peer,
        mode,
        step: Some(step),
    }
}

impl PeerJob {
    /// The renderer's name for people.
    #[must_use]
    pub fn renderer(&self) -> &'static str {
        match self.peer {
            "vtk-gpu-egl" => "VTK GPU",
            "vtk-fixedpoint" => "VTK fixed-point",
            "vispy-egl" => "vispy",
            other => other,
        }
    }
}

impl PeerWork {
    /// The methods that a chart has beside the candidates of the table.
    #[must_use]
    pub fn charted(self) -> &'static [&'static [&'static str]] {
        const SOFTWARE: &str = "image.renderer=software";
        const POST: &str = "image.slots.classify=post";
        const INTEGRAL: &str = "image.slots.classify=integral_1d";
        const PREINTEGRATED: &str = "image.slots.classify=preintegrated_2d";
        match self {
            Self::Dvr => &[
                &[SOFTWARE, POST, "image.step=4"],
                &[SOFTWARE, POST, "image.step=0.5"],
                &[SOFTWARE, INTEGRAL, "image.step=2"],
                &[SOFTWARE, INTEGRAL, "image.step=1"],
                &[POST, "image.step=2"],
                &[POST, "image.step=0.25"],
                &[PREINTEGRATED, "image.step=4"],
            ],
            Self::Mip => &[
                &["image.extremum=samples", "image.step=2"],
                &["image.extremum=field", "image.step=2"],
            ],
            Self::Isosurface => &[],
        }
    }
}
