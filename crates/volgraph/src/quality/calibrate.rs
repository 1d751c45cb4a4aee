//! Drawing small views to find the method for a budget.
//!
//! For each way to classify, the error is taken to fall with the step: from one voxel the search goes up or down by
//! octaves until the budget lies in between, and then halves what is left. So a dozen small pictures are drawn for each.
//! Storages of the volume are only tried with the way that came out best. Times are measured on the picture's own size
//! (or a smaller one of the same shape, and scaled), all methods in turn.

use std::sync::Arc;
use std::time::Instant;

use volgraph_gpu::Gpu;
use volgraph_graph::{Budget, Camera, Plan, View};
use volgraph_measure::timing::Summary;
use volgraph_reference::Silent;
use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

use super::Chosen;
use crate::methods::{
    Axis, FINE_STEP, Method, MethodSpace, Ready, SessionStand, Setting, TruthKind, Yardstick,
    alternate, middle, turned,
};
use crate::overrides::ParamOverride;
use crate::scene::Scene;
use crate::session::{Change, Outcome, Session, SessionOptions};
use crate::truth::TruthOptions;

/// The longer side of the small views, in pixels.
const SMALL: u32 = 96;

/// The small views: degrees that the camera is turned by.
const TURNS: [f64; 3] = [0.0, 120.0, 240.0];

/// Steps are 2^(rung / 4) voxels.
const FINEST: i32 = -16;
const COARSEST: i32 = 16;
const RUNGS_TO_AN_OCTAVE: i32 = 4;

/// The share of an error budget that a small view may take: others differ a little.
const SHARE: f64 = 0.8;

/// The share of a time budget that is planned with.
const TIME_SHARE: f64 = 0.9;

/// Most pixels that times are measured with. A processor's time goes with the pixels; on a GPU small pictures tell nothing.
const TIMED_PIXELS: f64 = 1024.0 * 1024.0;
const TIMED_PIXELS_OF_SOFTWARE: f64 = 256.0 * 256.0;

/// Frames that a time is the median of.
const ROUNDS: u32 = 3;

/// What is varied beside the step.
const CLASSIFY: &str = "classify";
const STORAGE: &str = "volume_storage";
const STEP: &str = "step";

/// A way to draw, but for its step.
#[derive(Clone, Debug, Default, PartialEq)]
struct Way {
    settings: Vec<Setting>,
}

impl Way {
    /// The method with a step; the graph's own where that is held.
    fn method(&self, step: Option<f64>) -> Method {
        let mut settings = self.settings.clone();
        settings.extend(step.map(|step| Setting {
            name: STEP.to_owned(),
            is_slot: false,
            value: ParamValue::Float(step),
        }));
        Method { settings }
    }

    fn with(&self, axis: &Axis, value: &ParamValue) -> Self {
        let mut way = self.clone();
        way.settings.retain(|setting| setting.name != axis.name);
        way.settings.push(Setting {
            name: axis.name.clone(),
            is_slot: axis.is_slot,
            value: value.clone(),
        });
        way
    }
}

/// A method with its error, and its time once that is known.
#[derive(Clone, Debug)]
struct Candidate {
    way: Way,
    step: Option<f64>,
    rmse: f64,
    ms: f64,
}

pub(super) fn calibrate(
    scene: &Scene,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
    plan: &Plan,
    node: &str,
    budget: Budget,
) -> Result<Option<Chosen>, Findings> {
    let shaders = scene.shader_library(gpu.capabilities());
    let space = MethodSpace::of(plan, shaders.roots(), &scene.registry, &[])?;
    // What is set by name is held.
    let is_held = |name: &str| {
        let mut sets = scene.overrides.params.iter();
        sets.any(|set| set.target == node && set.name == name)
    };
    let axis = |name: &str| {
        let mut axes = space.axes.iter();
        axes.find(|axis| axis.name == name && !is_held(name))
    };
    let (classify, storage) = (axis(CLASSIFY), axis(STORAGE));
    let has_step = axis(STEP).is_some();
    if classify.is_none() && storage.is_none() && !has_step {
        return Ok(None);
    }
    let mut trial = Trial::new(scene, gpu, options, plan, node, budget, has_step)?;
    let base = Way::default();
    let ways: Vec<Way> = match classify {
        Some(axis) => axis
            .values
            .iter()
            .map(|value| base.with(axis, value))
            .collect(),
        None => vec![base],
    };
    let mut found = trial.candidates(&ways, budget);
    if found.is_empty() {
        return Err(trial
            .refused
            .into_iter()
            .next()
            .unwrap_or_else(|| Finding::error("quality", "no method can draw this graph").into()));
    }
    trial.time(&mut found)?;
    let mut best = best(&found, budget).clone();
    if let Some(axis) = storage {
        let others: Vec<Way> = axis
            .values
            .iter()
            .map(|value| best.way.with(axis, value))
            .collect();
        let mut found = trial.candidates(&others, budget);
        // In turn with the best so far: times of different minutes do not compare.
        found.push(best);
        trial.time(&mut found)?;
        best = self::best(&found, budget).clone();
    }
    if let Budget::TimeMs(most) = budget {
        trial.hold_time(&mut best, most)?;
    }
    let is_met = match budget {
        Budget::Rmse(rmse) => best.rmse <= rmse,
        Budget::TimeMs(time) => best.ms <= time,
    };
    Ok(Some(Chosen {
        budget,
        node: node.to_owned(),
        method: best.way.method(best.step),
        predicted_rmse: best.rmse,
        predicted_ms: best.ms,
        is_met,
        truth: trial.kind(),
        tried: trial.tried,
        is_kept: false,
    }))
}

/// The fastest of those inside an error budget, or the most accurate inside a time; where none is inside, the nearest.
fn best(found: &[Candidate], budget: Budget) -> &Candidate {
    // What is limited, and what is then made as good as it can be.
    let (most, is_of_time) = match budget {
        Budget::Rmse(rmse) => (SHARE * rmse, false),
        Budget::TimeMs(time) => (time, true),
    };
    let over = |it: &Candidate| if is_of_time { it.ms } else { it.rmse };
    let cost = |it: &Candidate| if is_of_time { it.rmse } else { it.ms };
    let mut best = &found[0];
    for candidate in &found[1..] {
        let is_better = match (over(best) <= most, over(candidate) <= most) {
            (true, true) => cost(candidate) < cost(best),
            (false, false) => over(candidate) < over(best),
            (_, is_inside) => is_inside,
        };
        if is_better {
            best = candidate;
        }
    }
    best
}

/// Small views and what they should be.
struct Trial<'a> {
    scene: &'a Scene,
    gpu: &'a Arc<Gpu>,
    node: &'a str,
    small: SessionOptions,
    timed: SessionOptions,
    /// How many times more pixels the picture has than what times are measured with.
    scale: f64,
    views: Vec<(Camera, Yardstick)>,
    has_step: bool,
    /// The stage that all are compared in: software drivers are fastest in one, and each session would find that out anew.
    stage: Option<ParamOverride>,
    tried: usize,
    /// Why ways were refused.
    refused: Vec<Findings>,
}

impl<'a> Trial<'a> {
    fn new(
        scene: &'a Scene,
        gpu: &'a Arc<Gpu>,
        options: &SessionOptions,
        plan: &Plan,
        node: &'a str,
        budget: Budget,
        has_step: bool,
    ) -> Result<Self, Findings> {
        let as_written = |size| SessionOptions {
            size,
            with_layers: false,
            is_as_written: true,
            ..options.clone()
        };
        let [width, height] = options.size.map(f64::from);
        let shrunk = |factor: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a part of the picture's size"
            )]
            let sides = [width, height].map(|side| (side * factor).round().max(1.0) as u32);
            sides
        };
        let small = shrunk((f64::from(SMALL) / width.max(height)).min(1.0));
        let is_software = gpu.adapter().class == "software";
        let most = if is_software {
            TIMED_PIXELS_OF_SOFTWARE
        } else {
            TIMED_PIXELS
        };
        let timed = shrunk((most / (width * height)).sqrt().min(1.0));
        let mut trial = Self {
            scene,
            gpu,
            node,
            small: as_written(small),
            timed: as_written(timed),
            scale: width * height / timed.map(f64::from).iter().product::<f64>(),
            views: Vec::new(),
            has_step,
            stage: is_software.then(|| ParamOverride {
                target: node.to_owned(),
                is_slot: false,
                name: "stage".to_owned(),
                value: ParamValue::Text("fragment".to_owned()),
                typed: format!("{node}.stage=fragment"),
            }),
            tried: 0,
            refused: Vec::new(),
        };
        trial.look_at(plan, budget)?;
        Ok(trial)
    }

    /// Finds out what the small views should be.
    fn look_at(&mut self, plan: &Plan, budget: Budget) -> Result<(), Findings> {
        let shaders = self.scene.shader_library(self.gpu.capabilities());
        let limits = self.small.limits(self.gpu);
        let small = self.scene.plan(&shaders, &limits, self.small.size, false)?;
        let target = middle(plan);
        let own = small.view();
        let tolerance = match budget {
            Budget::Rmse(rmse) => (1e-2 * rmse).clamp(1e-8, 1e-5),
            Budget::TimeMs(_) => 1e-6,
        };
        let truth = TruthOptions {
            tolerance,
            cache: self.small.cache.clone(),
        };
        for degrees in TURNS {
            let view = View {
                camera: turned(&own.camera, target, degrees),
                ..own
            };
            let yardstick = match Yardstick::reference(&small, &view, &truth, &Silent) {
                Ok(yardstick) => yardstick,
                Err(findings) if !is_uncovered(&findings) => return Err(findings),
                Err(_) => self.fine(&small, &view)?,
            };
            self.views.push((view.camera, yardstick));
        }
        Ok(())
    }

    /// A view drawn so finely that it stands for the truth.
    fn fine(&self, plan: &Plan, view: &View) -> Result<Yardstick, Findings> {
        let fine = Way::default().method(self.has_step.then_some(FINE_STEP));
        let mut session = self.session(&fine, &self.small)?;
        session.place_camera(view.camera);
        let (picture, _) = session.render_checked()?;
        Yardstick::fine(plan, view, picture)
    }

    fn kind(&self) -> TruthKind {
        self.views
            .first()
            .map_or(TruthKind::Fine, |(_, yardstick)| yardstick.kind)
    }

    fn session(&self, method: &Method, options: &SessionOptions) -> Result<Session, Findings> {
        let mut overrides = self.scene.overrides.clone();
        // What is set by name holds.
        overrides.params.splice(0..0, self.stage.clone());
        overrides.params.extend(method.overrides(self.node));
        let scene = self
            .scene
            .with_overrides(&overrides, &crate::scene::NoProgress)?;
        Session::start(scene, Arc::clone(self.gpu), options)
    }

    /// Of each way the method that the budget asks for; ways that the scene refuses are left out.
    fn candidates(&mut self, ways: &[Way], budget: Budget) -> Vec<Candidate> {
        let mut found = Vec::new();
        for way in ways {
            let candidate = match budget {
                Budget::Rmse(rmse) => self.longest_step(way, SHARE * rmse),
                Budget::TimeMs(time) => self.shortest_step(way, TIME_SHARE * time),
            };
            match candidate {
                Ok(candidate) => found.push(candidate),
                Err(findings) => self.refused.push(findings),
            }
        }
        found
    }

    /// The longest step whose error is at most `most`; the shortest one where none is.
    fn longest_step(&mut self, way: &Way, most: f64) -> Result<Candidate, Findings> {
        let mut session = self.session(&way.method(self.step(0)), &self.small)?;
        let mut error = self.error(&mut session)?;
        let candidate = |rung: Option<f64>, rmse: f64| Candidate {
            way: way.clone(),
            step: rung,
            rmse,
            ms: f64::INFINITY,
        };
        if !self.has_step {
            return Ok(candidate(None, error));
        }
        // The longest rung known to be inside, and the shortest known to be outside.
        let (mut inside, mut outside) = (None, None);
        let mut rung = 0;
        loop {
            if error <= most {
                inside = Some((rung, error));
            } else {
                outside = Some(rung);
            }
            let next = match (inside, outside) {
                (Some((low, _)), Some(high)) => low + (high - low) / 2,
                (Some((low, _)), None) => (low + RUNGS_TO_AN_OCTAVE).min(COARSEST),
                (None, Some(high)) => (high - RUNGS_TO_AN_OCTAVE).max(FINEST),
                (None, None) => rung,
            };
            if next == rung || inside.is_some_and(|(low, _)| next == low) {
                break;
            }
            rung = next;
            error = self.error_at(&mut session, rung)?;
        }
        let (rung, rmse) = inside.unwrap_or((rung, error));
        Ok(candidate(self.step(rung), rmse))
    }

    /// The shortest step with which a frame takes at most `most` milliseconds.
    fn shortest_step(&mut self, way: &Way, most: f64) -> Result<Candidate, Findings> {
        let mut candidate = Candidate {
            way: way.clone(),
            step: self.step(0),
            rmse: f64::INFINITY,
            ms: f64::INFINITY,
        };
        if self.has_step {
            // A frame takes about as long as a constant and a share for each segment.
            let mut probes = [1.0, 4.0].map(|step| Candidate {
                step: Some(step),
                ..candidate.clone()
            });
            self.time(&mut probes)?;
            let share = (probes[0].ms - probes[1].ms) / (1.0 - 0.25);
            let rest = probes[0].ms - share;
            let ideal = if share > 0.0 && most > rest {
                share / (most - rest)
            } else if most > rest {
                0.0
            } else {
                f64::INFINITY
            };
            let (finest, coarsest) = (octaves(FINEST), octaves(COARSEST));
            candidate.step = Some(ideal.clamp(finest, coarsest));
        }
        let mut session = self.session(&way.method(candidate.step), &self.small)?;
        candidate.rmse = self.error(&mut session)?;
        Ok(candidate)
    }

    /// Lengthens the step until a frame takes no longer than the budget.
    fn hold_time(&mut self, best: &mut Candidate, most: f64) -> Result<(), Findings> {
        for _ in 0..6 {
            self.time(std::slice::from_mut(best))?;
            let Some(step) = best.step.filter(|_| best.ms > TIME_SHARE.sqrt() * most) else {
                break;
            };
            let longer = step * (best.ms / (TIME_SHARE * most)).max(1.05);
            if longer > octaves(COARSEST) {
                break;
            }
            best.step = Some(longer);
        }
        let mut session = self.session(&best.way.method(best.step), &self.small)?;
        best.rmse = self.error(&mut session)?;
        Ok(())
    }

    fn step(&self, rung: i32) -> Option<f64> {
        self.has_step.then(|| octaves(rung))
    }

    /// The error at another step.
    fn error_at(&mut self, session: &mut Session, rung: i32) -> Result<f64, Findings> {
        let step = ParamOverride {
            target: self.node.to_owned(),
            is_slot: false,
            name: STEP.to_owned(),
            value: ParamValue::Float(octaves(rung)),
            typed: format!("{}.{STEP}={}", self.node, octaves(rung)),
        };
        match session.apply(&Change::Set(vec![step])) {
            Ok(Outcome::Drawn(_) | Outcome::Unchanged) => self.error(session),
            Err(refused) => Err(refused.findings),
        }
    }

    /// The largest root mean square error of the small views.
    fn error(&mut self, session: &mut Session) -> Result<f64, Findings> {
        self.tried += 1;
        let mut worst: f64 = 0.0;
        for (camera, yardstick) in &self.views {
            session.place_camera(*camera);
            let (picture, _) = session.render_checked()?;
            worst = worst.max(yardstick.errors(&picture)?.rmse);
        }
        Ok(worst)
    }

    /// Times candidates in turn.
    fn time(&mut self, found: &mut [Candidate]) -> Result<(), Findings> {
        let mut ready = Vec::new();
        for candidate in found.iter() {
            let method = candidate.way.method(candidate.step);
            ready.push(Ready::new(self.session(&method, &self.timed)?));
        }
        let Some((_, yardstick)) = self.views.first() else {
            return Ok(());
        };
        let mut stand = SessionStand {
            scene: self.scene,
            gpu: Arc::clone(self.gpu),
            options: self.timed.clone(),
            node: self.node.to_owned(),
            yardstick,
            on_picture: Box::new(|_, _, _| Ok(())),
            started: Instant::now(),
        };
        let mut methods: Vec<&mut Ready> = ready.iter_mut().collect();
        // The first frame makes tables and pipelines.
        for warm in alternate(&mut stand, &mut methods, 1..2, |_, _| true) {
            warm?;
        }
        let times = alternate(&mut stand, &mut methods, 2..2 + ROUNDS, |_, _| true);
        for (candidate, times) in found.iter_mut().zip(times) {
            let summary = Summary::of(&times?)
                .map_err(|error| Finding::error("quality", error.to_string()))?;
            candidate.ms = summary.median * self.scale;
        }
        Ok(())
    }
}

fn octaves(rung: i32) -> f64 {
    (f64::from(rung) / f64::from(RUNGS_TO_AN_OCTAVE)).exp2()
}

fn is_uncovered(findings: &Findings) -> bool {
    findings
        .sorted()
        .iter()
        .any(|finding| finding.code == "not-covered")
}
