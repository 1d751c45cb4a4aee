//! Small views of a scene and what they should be, and a session for each way to draw them.
//!
//! A session lives as long as its way is in the running: another step is a change of it, and so is the size that times
//! are measured at. What all of them hold on the device together is bounded; beyond that they are opened again.

use std::sync::Arc;

use glam::DVec3;
use volgraph_gpu::Gpu;
use volgraph_graph::{Budget, Camera, View};
use volgraph_measure::timing::Summary;
use volgraph_picture::Picture;
use volgraph_reference::Silent;
use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

use super::Sample;
use super::search::{self, Figures};
use crate::methods::{
    Axis, Frames, Method, Setting, TruthKind, Yardstick, alternate, fine_method, is_uncovered,
    shortest_step, timed_frame, turned,
};
use crate::overrides::ParamOverride;
use crate::renderer;
use crate::scene::Scene;
use crate::session::{Change, Outcome, Session, SessionOptions};
use crate::truth::TruthOptions;

/// The longer side of the small views, in pixels.
const SMALL: u32 = 96;

/// The small views: degrees that the camera is turned by.
const TURNS: [f64; 3] = [0.0, 120.0, 240.0];

/// Most pixels that times are measured with, of a choice and of a promise. A processor's time goes with the pixels; on a
/// GPU small pictures tell nothing.
const TIMED_PIXELS: f64 = 1024.0 * 1024.0;
const TIMED_PIXELS_OF_SOFTWARE: f64 = 192.0 * 192.0;

/// Frames that a time is the median of.
const ROUNDS: u32 = 3;

/// Who takes so many times longer than the fastest is not timed with care.
const FAR_BEHIND: f64 = 1.6;

/// Most bytes that sessions hold on the device at once, but for one that is larger alone.
const HELD_BYTES: u64 = 1 << 30;

/// The share of an error budget that a small view may take: others differ a little.
pub(super) const SHARE: f64 = 0.8;

pub(super) const STEP: &str = "step";

/// A way to draw, but for its step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Way {
    settings: Vec<Setting>,
}

impl Way {
    /// The method with a step; the graph's own where that is held.
    pub fn method(&self, step: Option<f64>) -> Method {
        let mut settings = self.settings.clone();
        settings.extend(step.map(step_setting));
        Method { settings }
    }

    /// Whether the software raycaster draws it.
    pub fn is_software(&self) -> bool {
        self.method(None).is_software()
    }

    pub fn with(&self, axis: &Axis, value: &ParamValue) -> Self {
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

fn step_setting(step: f64) -> Setting {
    Setting {
        name: STEP.to_owned(),
        is_slot: false,
        value: ParamValue::Float(step),
    }
}

/// A way in the running.
pub(super) struct Entrant {
    pub way: Way,
    /// Its step, where the step is free.
    pub step: Option<f64>,
    /// The largest root mean square error of the small views; infinite until it is known.
    pub rmse: f64,
    /// A frame of the picture's size, in milliseconds; infinite until it is known.
    pub ms: f64,
    session: Option<Session>,
    /// Where the camera stands before it turns.
    camera: Camera,
    bytes: u64,
}

impl Entrant {
    pub fn figures(&self) -> Figures {
        Figures {
            rmse: self.rmse,
            ms: self.ms,
        }
    }
}

/// The views and what they should be.
pub(super) struct Trial<'a> {
    scene: Scene,
    gpu: &'a Arc<Gpu>,
    node: &'a str,
    small: SessionOptions,
    /// The sizes that choices and promises are timed at.
    timed: [u32; 2],
    promised: [u32; 2],
    /// The picture's own.
    size: [u32; 2],
    pixels: f64,
    /// What the camera turns about.
    target: DVec3,
    views: Vec<(Camera, Yardstick)>,
    pub has_step: bool,
    /// No ray is walked in shorter steps: a rung.
    pub finest: i32,
    /// The tolerance of the small views' truth.
    tolerance: f64,
    /// Methods that were drawn.
    pub tried: usize,
    /// Who lost a race: without a session.
    beaten: Vec<Entrant>,
    /// Why ways were refused.
    pub refused: Vec<Findings>,
}

impl<'a> Trial<'a> {
    pub fn new(
        scene: &Scene,
        gpu: &'a Arc<Gpu>,
        options: &SessionOptions,
        node: &'a str,
        budget: Budget,
        has_step: bool,
    ) -> Result<Self, Findings> {
        let [width, height] = options.size.map(f64::from);
        let shrunk = |factor: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a part of the picture's size"
            )]
            let sides =
                [width, height].map(|side| (side * factor.min(1.0)).round().max(1.0) as u32);
            sides
        };
        let within = |pixels: f64| shrunk((pixels / (width * height)).sqrt());
        let is_software = gpu.adapter().class == "software";
        let promised = within(TIMED_PIXELS);
        let timed = if is_software {
            within(TIMED_PIXELS_OF_SOFTWARE)
        } else {
            promised
        };
        let mut trial = Self {
            scene: in_one_stage(scene, node, is_software)?,
            gpu,
            node,
            small: SessionOptions {
                size: shrunk(f64::from(SMALL) / width.max(height)),
                with_layers: false,
                is_as_written: true,
                ..options.clone()
            },
            timed,
            promised,
            size: options.size,
            pixels: width * height,
            target: DVec3::ZERO,
            views: Vec::new(),
            has_step,
            finest: search::finest_rung(0.0),
            // Well below what is asked for.
            tolerance: match budget {
                Budget::Rmse(rmse) => (1e-2 * rmse).clamp(1e-8, 1e-5),
                Budget::TimeMs(_) => 1e-6,
            },
            tried: 0,
            beaten: Vec::new(),
            refused: Vec::new(),
        };
        trial.look()?;
        Ok(trial)
    }

    /// Finds out what the small views should be.
    fn look(&mut self) -> Result<(), Findings> {
        let shaders = self.scene.shader_library(self.gpu.capabilities());
        let limits = self.small.limits(self.gpu);
        let plan = self.scene.plan(&shaders, &limits, self.small.size, false)?;
        self.target = crate::methods::middle(&plan);
        if self.has_step {
            self.finest = search::finest_rung(shortest_step(&plan)?);
        }
        let truth = TruthOptions {
            tolerance: self.tolerance,
            cache: self.small.cache.clone(),
        };
        let own = plan.view();
        let mut fine = None;
        for degrees in TURNS {
            let view = View {
                camera: turned(&own.camera, self.target, degrees),
                ..own
            };
            let yardstick = match Yardstick::reference(&plan, &view, &truth, &Silent) {
                Ok(yardstick) => yardstick,
                Err(findings) if !is_uncovered(&findings) => return Err(findings),
                // Drawn so finely that it stands for the truth.
                Err(_) => {
                    let session = match &mut fine {
                        Some(session) => session,
                        None => fine.insert(self.session(&fine_method(&plan)?)?),
                    };
                    session.place_camera(view.camera);
                    let (picture, _) = session.render_checked()?;
                    Yardstick::fine(&plan, &view, picture)?
                }
            };
            self.views.push((view.camera, yardstick));
        }
        Ok(())
    }

    pub fn kind(&self) -> TruthKind {
        self.views
            .first()
            .map_or(TruthKind::Fine, |(_, yardstick)| yardstick.kind)
    }

    fn session(&self, method: &Method) -> Result<Session, Findings> {
        let scene = self.scene.with_sets(&method.overrides(self.node))?;
        Session::start(scene, Arc::clone(self.gpu), &self.small)
    }

    /// A way with a session at the small size.
    pub fn enter(&self, way: Way, step: f64) -> Result<Entrant, Findings> {
        let step = self.has_step.then_some(step);
        let session = self.session(&way.method(step))?;
        let allocations = session.plan().allocations.iter();
        Ok(Entrant {
            bytes: allocations.map(|it| it.resource.bytes()).sum(),
            camera: session.view().camera,
            way,
            step,
            rmse: f64::INFINITY,
            ms: f64::INFINITY,
            session: Some(session),
        })
    }

    /// Lets go of an entrant's memory where all of them hold too much.
    pub fn rest(&self, entrant: &mut Entrant, others: &[Entrant]) {
        let held = |it: &Entrant| it.session.as_ref().map_or(0, |_| it.bytes);
        if others.iter().map(held).sum::<u64>() + held(entrant) > HELD_BYTES {
            entrant.session = None;
        }
    }

    /// An entrant's session, opened again where it rests.
    fn wake<'e>(&self, entrant: &'e mut Entrant) -> Result<&'e mut Session, Findings> {
        match &mut entrant.session {
            Some(session) => Ok(session),
            rests => Ok(rests.insert(self.session(&entrant.way.method(entrant.step))?)),
        }
    }

    /// Gives an entrant another step.
    pub fn set_step(&self, entrant: &mut Entrant, step: f64) -> Result<(), Findings> {
        if entrant.step.is_none_or(|known| known == step) {
            return Ok(());
        }
        let method = Method {
            settings: vec![step_setting(step)],
        };
        let change = Change::Set(method.overrides(self.node));
        apply(self.wake(entrant)?, &change)?;
        entrant.step = Some(step);
        (entrant.rmse, entrant.ms) = (f64::INFINITY, f64::INFINITY);
        Ok(())
    }

    /// The shortest step that is tried, in voxels.
    pub fn finest_step(&self) -> f64 {
        search::step(self.finest)
    }

    fn resize(&self, entrant: &mut Entrant, size: [u32; 2]) -> Result<(), Findings> {
        let session = self.wake(entrant)?;
        if session.view().size != size {
            apply(session, &Change::Size(size))?;
        }
        Ok(())
    }

    /// Some pixels of the picture itself, and what they should be; `None` where the reference does not compute them.
    pub fn sample(&mut self, entrant: &mut Entrant) -> Result<Option<Sample>, Findings> {
        let tolerance = self.tolerance;
        let session = self.at_its_size(entrant)?;
        Ok(Sample::of(session.plan(), session.view(), tolerance))
    }

    /// Draws the picture itself by an entrant.
    pub fn picture(&mut self, entrant: &mut Entrant) -> Result<Picture, Findings> {
        self.tried += 1;
        Ok(self.at_its_size(entrant)?.render_checked()?.0)
    }

    /// An entrant's session with the picture's own size and camera, which follows the size.
    fn at_its_size<'e>(&self, entrant: &'e mut Entrant) -> Result<&'e mut Session, Findings> {
        self.resize(entrant, self.size)?;
        let session = self.wake(entrant)?;
        session.place_camera(session.plan().view().camera);
        Ok(session)
    }

    /// Draws the small views by an entrant.
    pub fn measure(&mut self, entrant: &mut Entrant) -> Result<f64, Findings> {
        self.tried += 1;
        self.resize(entrant, self.small.size)?;
        let session = self.wake(entrant)?;
        let mut worst: f64 = 0.0;
        for (camera, yardstick) in &self.views {
            session.place_camera(*camera);
            let (picture, _) = session.render_checked()?;
            worst = worst.max(yardstick.errors(&picture)?.rmse);
        }
        entrant.rmse = worst;
        Ok(worst)
    }

    /// Times entrants in turn and gives what is best of them; what fails is left out. No more take part at once than may
    /// hold memory together: then the best goes on to the others.
    pub fn race(&mut self, entrants: Vec<Entrant>, budget: Budget) -> Option<Entrant> {
        let mut waiting = entrants.into_iter().peekable();
        let mut best: Option<Entrant> = None;
        while waiting.peek().is_some() {
            let mut batch: Vec<Entrant> = best.take().into_iter().collect();
            let mut bytes: u64 = batch.iter().map(|it| it.bytes).sum();
            let best_alone = batch.len();
            while let Some(next) = waiting
                .next_if(|next| batch.len() == best_alone || bytes + next.bytes <= HELD_BYTES)
            {
                bytes += next.bytes;
                batch.push(next);
            }
            let mut batch = self.time_all(batch, self.timed);
            let figures: Vec<Figures> = batch.iter().map(Entrant::figures).collect();
            best = search::best(&figures, budget, SHARE).map(|at| batch.swap_remove(at));
            self.beaten.extend(batch.into_iter().map(|mut entrant| {
                entrant.session = None;
                entrant
            }));
        }
        best
    }

    /// The fastest that was beaten, of those whose error in the small views is at most `most` and who take less than `ms`;
    /// each once.
    pub fn next_best(&mut self, most: f64, ms: f64) -> Option<Entrant> {
        let inside = self.beaten.iter().enumerate();
        let inside = inside.filter(|(_, it)| it.rmse <= most && it.ms < ms);
        let (at, _) = inside.min_by(|(_, a), (_, b)| a.ms.total_cmp(&b.ms))?;
        Some(self.beaten.swap_remove(at))
    }

    /// A frame of the picture's size by an entrant alone, in milliseconds: as it is promised.
    pub fn time(&mut self, entrant: Entrant, is_promise: bool) -> Result<Entrant, Findings> {
        let size = if is_promise {
            self.promised
        } else {
            self.timed
        };
        match self.time_all(vec![entrant], size).pop() {
            Some(timed) => Ok(timed),
            None => Err(self.refused.pop().unwrap_or_default()),
        }
    }

    fn time_all(&mut self, entrants: Vec<Entrant>, size: [u32; 2]) -> Vec<Entrant> {
        let mut ready = Vec::new();
        for mut entrant in entrants {
            match self.resize(&mut entrant, size) {
                Ok(()) => ready.push(entrant),
                Err(findings) => self.refused.push(findings),
            }
        }
        let mut frames = Turning(self.target);
        let scale = self.pixels / size.map(f64::from).iter().product::<f64>();
        // A change of size has drawn a frame, so that tables and pipelines are there. Who is then far behind in the next is
        // not drawn again.
        let once = self.draw(&mut frames, ready, 1..2, scale);
        let least = once.iter().map(|it| it.ms).fold(f64::INFINITY, f64::min);
        let (near, far): (Vec<_>, Vec<_>) =
            once.into_iter().partition(|it| it.ms <= FAR_BEHIND * least);
        let mut timed = self.draw(&mut frames, near, 2..2 + ROUNDS, scale);
        timed.extend(far);
        timed
    }

    /// Draws frames by entrants in turn and notes the medians of their times; what fails is left out.
    fn draw(
        &mut self,
        frames: &mut Turning,
        mut ready: Vec<Entrant>,
        numbers: std::ops::Range<u32>,
        scale: f64,
    ) -> Vec<Entrant> {
        let mut all: Vec<&mut Entrant> = ready.iter_mut().collect();
        let times = alternate(frames, &mut all, numbers, |_, _| true);
        let mut drawn = Vec::new();
        for (mut entrant, times) in ready.into_iter().zip(times) {
            let summary = times.and_then(|times| {
                Summary::of(&times)
                    .map_err(|error| Finding::error("quality", error.to_string()).into())
            });
            match summary {
                Ok(summary) => {
                    entrant.ms = summary.median * scale;
                    drawn.push(entrant);
                }
                Err(findings) => self.refused.push(findings),
            }
        }
        drawn
    }
}

/// The frames of entrants, turning about a point.
struct Turning(DVec3);

impl Frames for Turning {
    type Ready = Entrant;

    fn frame(&mut self, entrant: &mut Entrant, number: u32) -> Result<f64, Findings> {
        let camera = turned(&entrant.camera, self.0, f64::from(number));
        let session = entrant.session.as_mut().ok_or_else(Findings::new)?;
        Ok(timed_frame(session, camera, true)?.0)
    }
}

/// A scene whose raycast is compared in one stage: software drivers are fastest in it, and each session would find that
/// out anew. What the graph states is held.
fn in_one_stage(scene: &Scene, node: &str, is_software: bool) -> Result<Scene, Findings> {
    // The software raycaster has none.
    let is_stated = |name: &str| {
        let desc = scene.desc.nodes.get(node);
        desc.is_some_and(|desc| desc.params.contains_key(name) || renderer::is_software(&desc.kind))
    };
    let stage = Method {
        settings: vec![Setting {
            name: "stage".to_owned(),
            is_slot: false,
            value: ParamValue::Text("fragment".to_owned()),
        }],
    };
    let sets: Vec<ParamOverride> = if is_software && !is_stated("stage") {
        stage.overrides(node)
    } else {
        Vec::new()
    };
    scene.with_sets(&sets)
}

fn apply(session: &mut Session, change: &Change) -> Result<(), Findings> {
    match session.apply(change) {
        Ok(Outcome::Drawn(_) | Outcome::Unchanged) => Ok(()),
        Err(refused) => Err(refused.findings),
    }
}
