//! Other renderers, run as programs: what they are asked, and what they answer.
//!
//! A worker takes a JSON object and prints a line `RESULT {…}` with the milliseconds of its frames. The names of peers,
//! modes and volumes are those of a harness whose scene is the ready graph `comparison` (see [`crate::methods::peers`]).

use serde::Serialize;
use serde_json::{Value, json};
use volgraph_measure::timing::{Summary, ratio};

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PeerWork {
    /// Emission and absorption.
    Dvr,
    /// Maximum intensity projection.
    Mip,
    /// A lit isosurface.
    Isosurface,
}

impl PeerWork {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Dvr, Self::Mip, Self::Isosurface];

    /// The largest error that volgraph's method may have, in 8-bit steps over core pixels; none where there is no truth.
    #[must_use]
    pub fn most_error(self) -> Option<f64> {
        match self {
            Self::Dvr => Some(1.0),
            Self::Mip => Some(0.6),
            Self::Isosurface => None,
        }
    }

    /// What is set in `comparison` to draw it.
    #[must_use]
    pub fn sets(self) -> &'static [&'static str] {
        match self {
            Self::Dvr => &["image.slots.light=unlit", "image.slots.traverse=skip"],
            Self::Mip => &[
                "image.slots.technique=mip",
                "image.slots.traverse=skip",
                "image.window_unit=normalised",
            ],
            Self::Isosurface => &[
                "image.slots.technique=isosurface",
                "image.slots.light=phong",
                "image.slots.traverse=skip",
                "image.isovalue=0.5",
            ],
        }
    }

    /// The methods of which the fastest that is accurate enough is taken.
    #[must_use]
    pub fn candidates(self) -> &'static [&'static [&'static str]] {
        match self {
            Self::Dvr => &[
                &[
                    "image.renderer=software",
                    "image.slots.classify=post",
                    "image.step=3",
                ],
                &[
                    "image.renderer=software",
                    "image.slots.classify=post",
                    "image.step=2.5",
                ],
                &[
                    "image.renderer=software",
                    "image.slots.classify=post",
                    "image.step=2",
                ],
                &[
                    "image.renderer=software",
                    "image.slots.classify=post",
                    "image.step=1",
                ],
                &["image.slots.classify=preintegrated_2d", "image.step=2"],
                &["image.slots.classify=preintegrated_2d", "image.step=1"],
                &["image.slots.classify=post", "image.step=1"],
                &["image.slots.classify=post", "image.step=0.5"],
                &["image.slots.classify=preintegrated_2d", "image.step=0.5"],
            ],
            Self::Mip => &[
                &[
                    "image.renderer=software",
                    "image.extremum=samples",
                    "image.step=1",
                ],
                &["image.renderer=software", "image.extremum=field"],
                &["image.extremum=samples", "image.step=1"],
                &["image.extremum=samples", "image.step=0.5"],
                &["image.extremum=field", "image.step=1"],
                &["image.extremum=samples", "image.step=0.25"],
            ],
            Self::Isosurface => &[
                &["image.renderer=software", "image.refinement=cubic"],
                &["image.refinement=cubic", "image.step=1"],
            ],
        }
    }
}

/// A worker's work.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerJob {
    /// What is drawn.
    pub work: PeerWork,
    /// The renderer.
    pub peer: &'static str,
    /// Its word for the work.
    pub mode: &'static str,
    /// Its step in voxels; its own default where `None`.
    pub step: Option<f64>,
}

const fn job(work: PeerWork, peer: &'static str, mode: &'static str, step: Option<f64>) -> PeerJob {
    PeerJob {
        work,
        peer,
        mode,
        step,
    }
}

/// The jobs.
pub const PEER_JOBS: [PeerJob; 13] = [
    job(PeerWork::Dvr, "vtk-gpu-egl", "composite", Some(1.0)),
    job(PeerWork::Dvr, "vtk-gpu-egl", "composite", Some(0.5)),
    job(PeerWork::Dvr, "vtk-fixedpoint", "composite", Some(1.0)),
    job(PeerWork::Dvr, "vtk-fixedpoint", "composite", Some(0.5)),
    job(PeerWork::Dvr, "vispy-egl", "translucent", Some(1.0)),
    job(PeerWork::Dvr, "vispy-egl", "translucent", Some(0.5)),
    job(PeerWork::Mip, "vtk-gpu-egl", "mip", Some(1.0)),
    job(PeerWork::Mip, "vtk-fixedpoint", "mip", Some(1.0)),
    job(PeerWork::Mip, "vispy-egl", "mip", Some(1.0)),
    job(PeerWork::Mip, "pygfx", "mip", None),
    job(PeerWork::Isosurface, "pygfx", "iso", None),
    job(PeerWork::Isosurface, "vtk-gpu-egl", "iso", Some(1.0)),
    job(PeerWork::Isosurface, "vispy-egl", "iso", Some(1.0)),
];

/// The harness's volumes, and the fields that they are.
pub const PEER_VOLUMES: [(&str, &str); 2] = [("ml", "marschner_lobb"), ("c60", "c60")];

impl PeerJob {
    /// Its name: renderer, mode, step.
    #[must_use]
    pub fn name(&self) -> String {
        let step = self
            .step
            .map_or_else(|| "default".to_owned(), |step| step.to_string());
        format!("{}/{}/{step}", self.peer, self.mode)
    }

    /// Whether it draws the box between the outermost voxel centres, and not all voxels whole.
    #[must_use]
    pub fn is_between_centres(&self) -> bool {
        self.peer.starts_with("vtk")
    }

    /// What the worker is given.
    #[must_use]
    pub fn request(&self, volume: &str, frames: u32, png: &str) -> Value {
        json!({
            "case": "normal", "vol": volume, "peer": self.peer, "mode": self.mode, "step": self.step, "opts": {},
            "frames": frames, "png": png,
        })
    }
}

/// The milliseconds of a worker's frames, from what it printed.
///
/// # Errors
/// What its answer lacks.
pub fn peer_times(printed: &str) -> Result<Vec<f64>, String> {
    let line = printed
        .lines()
        .find_map(|line| line.strip_prefix("RESULT "));
    let line = line.ok_or("it printed no line RESULT")?;
    let answer: Value =
        serde_json::from_str(line).map_err(|error| format!("its RESULT is no JSON: {error}"))?;
    let times = answer["times"]
        .as_array()
        .ok_or("its RESULT has no `times`")?;
    let times: Option<Vec<f64>> = times
        .iter()
        .map(|time| time.as_f64().filter(|time| *time > 0.0))
        .collect();
    times
        .filter(|times| !times.is_empty())
        .ok_or_else(|| "its `times` are no milliseconds".to_owned())
}

/// A renderer beside volgraph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerRow {
    /// The volume.
    pub volume: String,
    /// The renderer's work.
    pub job: PeerJob,
    /// Its error in 8-bit steps over core pixels.
    pub error: Option<f64>,
    /// Milliseconds of its frames, of all rounds.
    pub frame_ms: Option<Summary>,
    /// Of each round, its median by volgraph's.
    pub ratio: Option<Summary>,
    /// What volgraph draws with.
    pub method: String,
    /// The error of that.
    pub method_error: Option<f64>,
    /// Milliseconds of volgraph's frames, of the same rounds.
    pub method_ms: Option<Summary>,
    /// Why the renderer was not timed.
    pub failed: Option<String>,
}

impl PeerRow {
    /// Takes the times of rounds.
    pub fn take(&mut self, rounds: &[PeerRound]) {
        let summary = |frames: fn(&PeerRound) -> &[f64]| {
            let all: Vec<f64> = rounds.iter().flat_map(frames).copied().collect();
            Summary::of(&all).ok()
        };
        let medians = |frames: fn(&PeerRound) -> &[f64]| -> Vec<f64> {
            let rounds = rounds.iter().map(|round| Summary::of(frames(round)));
            rounds.flatten().map(|round| round.median).collect()
        };
        let theirs: fn(&PeerRound) -> &[f64] = |round| &round.peer_ms;
        let ours: fn(&PeerRound) -> &[f64] = |round| &round.own_ms;
        self.frame_ms = summary(theirs);
        self.method_ms = summary(ours);
        self.ratio = ratio(&medians(theirs), &medians(ours)).ok();
    }
}

/// One round: milliseconds of frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerRound {
    /// The renderer's.
    pub peer_ms: Vec<f64>,
    /// volgraph's.
    pub own_ms: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_read_or_refused_with_a_reason() {
        let printed = "a warning\nRESULT {\"times\": [3.5, 4], \"first_ms\": 9}\n";
        assert_eq!(peer_times(printed).unwrap(), [3.5, 4.0]);
        for (printed, why) in [
            ("", "no line RESULT"),
            ("RESULT {", "no JSON"),
            ("RESULT {}", "no `times`"),
            ("RESULT {\"times\": []}", "no milliseconds"),
            ("RESULT {\"times\": [\"1\"]}", "no milliseconds"),
            ("RESULT {\"times\": [0]}", "no milliseconds"),
        ] {
            assert!(peer_times(printed).unwrap_err().contains(why), "{printed}");
        }
    }

    #[test]
    fn ratios_are_of_the_medians_of_rounds() {
        let mut row = PeerRow {
            volume: "c60".to_owned(),
            job: PEER_JOBS[0].clone(),
            error: None,
            frame_ms: None,
            ratio: None,
            method: String::new(),
            method_error: None,
            method_ms: None,
            failed: None,
        };
        // The machine is twice as slow in the second round.
        let round = |peer_ms: &[f64], own_ms: &[f64]| PeerRound {
            peer_ms: peer_ms.to_vec(),
            own_ms: own_ms.to_vec(),
        };
        row.take(&[
            round(&[40.0, 44.0, 90.0], &[4.0, 4.0]),
            round(&[88.0], &[8.0, 8.0, 8.0]),
        ]);
        let ratio = row.ratio.unwrap();
        assert_eq!((ratio.min, ratio.max, ratio.n), (11.0, 11.0, 2));
        assert_eq!(row.frame_ms.unwrap().n, 4);
        assert_eq!(PEER_JOBS[0].request("ml", 3, "x.png")["step"], 1.0);
        assert_eq!(PEER_JOBS[9].name(), "pygfx/mip/default");
    }
}
