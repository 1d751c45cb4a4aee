//! What the drawing thread tells the interface.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use volgraph_engine::quality::Chosen;
use volgraph_engine::{
    Camera, Change, ChangeReport, Findings, FrameReport, Gpu, Picture, Plan, RayStudy, Scene,
    Shown, SourceProgress,
};

use super::{Wake, locked};
use crate::looked::Looked;

/// How many notes are kept.
const NOTES: usize = 200;

/// Everything that there is to see.
#[derive(Default)]
pub struct Told {
    /// The picture to show; it stays where what comes after is refused.
    pub shown: Option<Shown>,
    /// Counts the pictures.
    pub serial: u64,
    /// Whether it has its full size.
    pub is_refined: bool,
    /// The camera that it was drawn with.
    pub camera: Option<Camera>,
    /// The plan that runs.
    pub plan: Option<Arc<Plan>>,
    /// The scene that is drawn.
    pub scene: Option<Scene>,
    /// The device that it is drawn on.
    pub gpu: Option<Arc<Gpu>>,
    /// What was chosen for the graph's budget.
    pub chosen: Option<Chosen>,
    /// What is wrong with what was tried last; empty where it was taken.
    pub findings: Findings,
    /// What the last change did.
    pub report: Option<ChangeReport>,
    /// What the last frame did.
    pub frame: Option<FrameReport>,
    /// Milliseconds of the last frame that was drawn.
    pub frame_ms: f64,
    /// What was done, the newest last.
    pub notes: VecDeque<Note>,
    /// The pictures after and before the last change.
    pub pictures: [Option<Arc<Picture>>; 2],
    /// The picture of the camera that stands still now.
    pub refined: Option<Arc<Picture>>,
    /// What the looked-at port holds.
    pub looked: Option<Arc<Looked>>,
    /// The comparison that was asked for last.
    pub error_map: Option<Result<Arc<ErrorMap>, Findings>>,
    /// Whether one is being made.
    pub is_comparing: bool,
    /// The ray that was studied last.
    pub ray: Option<Result<Arc<RayStudy>, Findings>>,
    /// Whether one is being studied.
    pub is_studying: bool,
    /// Whether something is being applied.
    pub is_busy: bool,
    /// Whether files are not followed.
    pub is_paused: bool,
    /// What is being read, and how much of it is.
    pub reading: Option<(String, f32)>,
}

impl Told {
    /// Keeps a picture after a change, beside the one before it.
    pub(super) fn keep(&mut self, picture: Picture) {
        let picture = Arc::new(picture);
        self.refined = Some(Arc::clone(&picture));
        let before = self.pictures[0].replace(picture);
        self.pictures[1] = before;
    }

    pub(super) fn note(&mut self, note: Note) {
        self.notes.push_back(note);
        while self.notes.len() > NOTES {
            self.notes.pop_front();
        }
    }

    /// Forgets what belongs to the graph before.
    pub(super) fn forget(&mut self) {
        self.pictures = [None, None];
        self.refined = None;
        self.report = None;
        self.looked = None;
        self.error_map = None;
        self.ray = None;
        self.reading = None;
    }
}

/// What was done at a change, in a line.
#[derive(Clone, Debug)]
pub struct Note {
    /// What it says.
    pub text: String,
}

impl Note {
    pub(super) fn new(text: String) -> Self {
        Self { text }
    }

    /// What a change was, what it built, and how long that took.
    pub(super) fn of(change: &Change, report: &ChangeReport, total: Duration) -> Self {
        let what = match change {
            Change::Files(_) => {
                let name = |path: &std::path::Path| match path.file_name() {
                    Some(name) => name.to_string_lossy().into_owned(),
                    None => path.display().to_string(),
                };
                let changed = report.changed.iter();
                let names: Vec<String> = changed.map(|file| name(&file.path)).collect();
                names.join(", ")
            }
            Change::Set(sets) => {
                let typed: Vec<&str> = sets.iter().map(|set| set.typed.as_str()).collect();
                typed.join(", ")
            }
            Change::Look(Some(port)) => format!("look at {port}"),
            Change::Look(None) => "look at no port".to_owned(),
            Change::Camera(_) => "camera".to_owned(),
            Change::Size([width, height]) => format!("{width} × {height}"),
        };
        let built = match report.pipelines_built.len() {
            0 => String::new(),
            1 => format!("; built {}", report.pipelines_built[0]),
            more => format!("; built {more} pipelines"),
        };
        let stages = &report.stages;
        let text = format!(
            "{what}: {:.0} ms (own {:.0}, driver {:.0}, frame {:.0}){built}",
            total.as_secs_f64() * 1e3,
            stages.own_ms(),
            stages.pipeline_ms,
            stages.draw_ms,
        );
        Self { text }
    }
}

/// How far a small picture is from its reference.
#[derive(Clone, Debug)]
pub struct ErrorMap {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The largest difference of a linear, premultiplied component, of each pixel; the top row first.
    pub errors: Vec<f32>,
    /// Root of the mean square over all components.
    pub rmse: f64,
    /// The largest.
    pub max: f32,
}

impl ErrorMap {
    pub(super) fn between(picture: &Picture, exact: &Picture) -> Self {
        let pairs = picture.color.iter().zip(&exact.color);
        let mut squares = 0.0;
        let errors: Vec<f32> = pairs
            .map(|(a, b)| {
                let mut largest = 0.0_f32;
                for (a, b) in a.iter().zip(b) {
                    squares += f64::from(a - b).powi(2);
                    largest = largest.max((a - b).abs());
                }
                largest
            })
            .collect();
        let count = (4 * errors.len()).max(1);
        Self {
            size: [picture.width, picture.height],
            max: errors.iter().copied().fold(0.0, f32::max),
            rmse: (squares / count as f64).sqrt(),
            errors,
        }
    }
}

/// Tells how much of a source is read.
pub(super) struct Progress(pub Arc<Mutex<Told>>, pub Arc<Mutex<Wake>>);

impl SourceProgress for Progress {
    fn progress(&self, source: &str, done: u64, total: u64) {
        let share = if total == 0 {
            0.0
        } else {
            done as f32 / total as f32
        };
        let is_done = total > 0 && done >= total;
        locked(&self.0).reading = (!is_done).then(|| (source.to_owned(), share));
        locked(&self.1)();
    }
}
