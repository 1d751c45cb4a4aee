//! volgraph's side of the comparison with other renderers: the scene, its truths, and methods that draw it.

use std::path::Path;
use std::sync::Arc;

use volgraph::bench::{BenchStand, Entry, PeerJob, PeerPoint, PeerWork, Rotation};
use volgraph::methods::{Frames, Yardstick};
use volgraph::truth::plan_without_device;
use volgraph::{
    Findings, Overrides, ParamOverride, Scene, Session, SessionOptions, TruthOptions, registry,
};
use volgraph_measure::timing::Summary;

use super::Bench;
use super::peers::failed;
use crate::commands::reference::Rows;

/// The harness's width and height.
const SIZE: [u32; 2] = [512, 512];
/// Frames of each renderer in a round.
pub const FRAMES: u32 = 3;
/// Of methods that take longer a turn has one frame.
const SLOW_MS: f64 = 300.0;
/// Far below the errors that are told.
const TOLERANCE: f64 = 1e-4;
/// The box between the outermost voxel centres of 128 voxels, in shares of the whole: half a voxel less at each side.
const BETWEEN_CENTRES: [&str; 3] = [
    "image.slots.clip=box",
    "image.clip_low=[0.00390625, 0.00390625, 0.00390625]",
    "image.clip_high=[0.99609375, 0.99609375, 0.99609375]",
];

/// The harness's scene.
fn scene(bench: &Bench<'_>, field: &str, work: PeerWork, more: &[&str]) -> Result<Scene, Findings> {
    let field = format!("volume.field={field}");
    let sets = std::iter::once(field.as_str())
        .chain(work.sets().iter().copied())
        .chain(more.iter().copied());
    let params = sets.map(|set| ParamOverride::parse(set).map_err(|why| failed(&why)));
    let overrides = Overrides {
        params: params.collect::<Result<_, _>>()?,
        ..Overrides::default()
    };
    let shaders = bench.args.shaders.folders();
    Scene::load(
        Path::new("embedded:/graphs/comparison.ron"),
        &overrides,
        &shaders,
        registry(),
        &bench.bars,
    )
}

fn truth(
    bench: &Bench<'_>,
    field: &str,
    work: PeerWork,
    more: &[&str],
) -> Result<Yardstick, Findings> {
    let scene = scene(bench, field, work, more)?;
    let plan = plan_without_device(&scene, SIZE)?;
    let options = TruthOptions {
        tolerance: TOLERANCE,
        ..TruthOptions::default()
    };
    let truth = Yardstick::reference(&plan, &plan.view(), &options, &Rows(&bench.bars));
    bench.bars.clear();
    truth
}

/// What pictures are held against; none where renderers do not agree on what they draw.
pub struct Truths {
    /// Of the box of whole voxels, which volgraph draws.
    pub whole: Option<Yardstick>,
    /// Of the box between voxel centres, where a job draws that.
    between_centres: Option<Yardstick>,
}

impl Truths {
    /// Those that jobs need.
    ///
    /// # Errors
    /// What the scene or the reference refuses.
    pub fn of(
        bench: &Bench<'_>,
        field: &str,
        work: PeerWork,
        jobs: &[&PeerJob],
    ) -> Result<Self, Findings> {
        let has_truth = work.most_error().is_some();
        let truth =
            |is_wanted: bool, more: &[&str]| is_wanted.then(|| truth(bench, field, work, more));
        let is_between = jobs.iter().any(|job| job.is_between_centres());
        Ok(Self {
            whole: truth(has_truth, &[]).transpose()?,
            between_centres: truth(has_truth && is_between, &BETWEEN_CENTRES).transpose()?,
        })
    }

    /// That of what a job draws.
    pub fn of_job(&self, job: &PeerJob) -> Option<&Yardstick> {
        if job.is_between_centres() {
            self.between_centres.as_ref()
        } else {
            self.whole.as_ref()
        }
    }
}

/// What volgraph draws with.
pub struct Method {
    /// What is set, as it is told.
    pub words: String,
    /// Its error in 8-bit steps over core pixels.
    pub error: Option<f64>,
    /// Milliseconds of its frames.
    times: Vec<f64>,
    entry: Entry,
    stand: BenchStand,
    /// The number of the next view: what was drawn last is not drawn again.
    next: u32,
}

impl Method {
    fn new(
        bench: &Bench<'_>,
        scene: Scene,
        sets: &[&str],
        truth: Option<&Yardstick>,
    ) -> Result<Self, Findings> {
        let session = SessionOptions {
            size: SIZE,
            ..bench.options.clone()
        };
        let error = match truth {
            Some(truth) => {
                let mut session = Session::start(scene.clone(), Arc::clone(&bench.gpu), &session)?;
                let (picture, _) = session.render_checked()?;
                Some(truth.errors(&picture)?.core_rmse_8bit * 255.0)
            }
            None => None,
        };
        // The harness turns by one degree from frame to frame.
        let mut stand = BenchStand::new(Rotation {
            turn_degrees: 1.0,
            degrees: (1..=FRAMES).map(f64::from).collect(),
        });
        let mut entry = Entry::new(scene, &bench.gpu, &session)?;
        let times = (0..=FRAMES).map(|number| stand.frame(&mut entry, number));
        let mut times = times.collect::<Result<Vec<_>, _>>()?;
        times.remove(0);
        stand.start();
        let words = sets.iter().map(|set| {
            set.trim_start_matches("image.")
                .trim_start_matches("slots.")
        });
        Ok(Self {
            words: words.collect::<Vec<_>>().join(" "),
            error,
            times,
            entry,
            stand,
            next: 0,
        })
    }

    /// Milliseconds of the next view's frame.
    ///
    /// # Errors
    /// What it fails with.
    pub fn frame(&mut self) -> Result<f64, Findings> {
        let time = self.stand.frame(&mut self.entry, self.next);
        self.next = (self.next + 1) % FRAMES;
        time
    }

    /// The median of its frames.
    fn median(&self) -> f64 {
        Summary::of(&self.times).map_or(f64::INFINITY, |times| times.median)
    }

    /// Its point of a chart.
    ///
    /// # Errors
    /// Where no frame was timed.
    pub fn point(&self, volume: &str, work: PeerWork) -> Result<PeerPoint, Findings> {
        Ok(PeerPoint {
            volume: volume.to_owned(),
            work,
            method: self.words.clone(),
            error: self.error,
            frame_ms: Summary::of(&self.times).map_err(|error| failed(&error.to_string()))?,
        })
    }
}

/// The candidates, each timed by a few frames; for a chart those of the chart as well.
///
/// # Errors
/// What a method's scene or the device refuses.
pub fn methods(
    bench: &Bench<'_>,
    field: &str,
    work: PeerWork,
    truth: Option<&Yardstick>,
) -> Result<Vec<Method>, Findings> {
    let more = bench.args.chart.as_ref().map(|_| work.charted());
    let all: Vec<_> = work
        .candidates()
        .iter()
        .chain(more.into_iter().flatten())
        .collect();
    let mut methods = Vec::new();
    for (number, sets) in all.iter().enumerate() {
        bench
            .bars
            .count("timing volgraph's methods", number as u64, all.len() as u64);
        let scene = scene(bench, field, work, sets)?;
        methods.push(Method::new(bench, scene, sets, truth)?);
    }
    bench.bars.clear();
    Ok(methods)
}

/// The fastest that is accurate enough.
pub fn fastest(methods: &[Method], work: PeerWork) -> Option<usize> {
    let is_exact = |method: &Method| {
        let bound = method.error.zip(work.most_error());
        bound.is_none_or(|(error, most)| error <= most)
    };
    let exact = (0..methods.len()).filter(|at| is_exact(&methods[*at]));
    exact.min_by(|a, b| methods[*a].median().total_cmp(&methods[*b].median()))
}

/// Some frames of each, in one order or the other.
///
/// # Errors
/// What a frame fails with.
pub fn take_turn(methods: &mut [Method], is_forwards: bool) -> Result<(), Findings> {
    let count = methods.len();
    for at in 0..count {
        let method = &mut methods[if is_forwards { at } else { count - 1 - at }];
        let frames = if method.median() > SLOW_MS { 1 } else { FRAMES };
        for _ in 0..frames {
            let time = method.frame()?;
            method.times.push(time);
        }
    }
    Ok(())
}
