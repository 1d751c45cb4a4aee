//! A session: one graph on one device, rendered as often as wanted, and changed while it lives.
//!
//! [`Session::open`] loads a graph and proves it; [`Session::render`] draws. [`Session::apply`] takes a [`Change`]: a
//! new state is made beside the one that works and drawn once, and only then does it take its place ([`apply`]). A
//! device that is lost is opened again, and what worked is installed on it. [`Session::dependencies`] are the files
//! to watch.

mod apply;
mod change;
mod compare;
mod open;
mod proof;
mod read_back;
mod tiles;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use volgraph_gpu::{
    AdapterChoice, AdapterSummary, FrameReport, Gpu, Installation, Runner, Shown, Texels,
};
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{Camera, CameraDesc, Plan, View};
use volgraph_picture::Picture;
use volgraph_report::Findings;
use volgraph_shader::SnapshotFiles;

pub use change::{Change, ChangeReport, ChangedFile, Drawn, Outcome, Refused, Stages};
pub use open::{SessionOptions, Unopened};
pub use tiles::{TILE_SIDE, has_to_be_tiled};

use self::read_back::{picture, read};
use crate::dependencies::Dependencies;
use crate::kept::KeptFiles;
use crate::overrides::Overrides;
use crate::quality::Chosen;
use crate::scene::Scene;

/// A graph on a device.
pub struct Session {
    options: SessionOptions,
    runner: Runner,
    state: State,
    /// All overrides that are wanted, those included for which there is no parameter at the moment.
    wanted: Overrides,
    /// What the last attempt read that was taken or was one of files.
    dependencies: Dependencies,
    /// Files whose change was refused, until a change of files is taken.
    pending: BTreeSet<PathBuf>,
    /// Why they were, until then.
    refused_files: Option<Findings>,
    /// Why the last change was refused.
    refused: Option<Findings>,
    /// Why the device was made again, until it is told.
    remade: Option<String>,
}

/// Everything that makes a picture.
struct State {
    scene: Scene,
    shaders: ShaderLibrary,
    /// The shaders' files as they were when it was made.
    snapshot: SnapshotFiles,
    installation: Installation,
    stance: Stance,
    view: View,
    /// What was chosen for the graph's budget.
    chosen: Option<Chosen>,
    /// Whether a picture of it has been looked at and found good.
    is_proven: bool,
}

/// Where the camera stands.
#[derive(Clone, Debug, PartialEq)]
enum Stance {
    /// Where the graph says.
    Graph,
    /// As described; what is open is fitted to the volumes.
    Fitted(CameraDesc),
    /// Exactly there.
    Exact(Camera),
}

impl Stance {
    fn view(&self, plan: &Plan) -> View {
        let view = plan.view();
        match self {
            Self::Graph => view,
            Self::Fitted(camera) => View {
                camera: plan.fit(camera),
                ..view
            },
            Self::Exact(camera) => View {
                camera: *camera,
                ..view
            },
        }
    }
}

impl Session {
    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.state.scene
    }

    /// The plan that runs.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        self.state.installation.plan()
    }

    /// The plan that runs, to keep.
    #[must_use]
    pub fn shared_plan(&self) -> Arc<Plan> {
        Arc::clone(self.state.installation.plan())
    }

    /// The device that it runs on now.
    #[must_use]
    pub fn gpu(&self) -> &Arc<Gpu> {
        self.runner.gpu()
    }

    /// What holds the last frame.
    pub(crate) fn installation(&self) -> &Installation {
        &self.state.installation
    }

    /// How it was opened.
    pub(crate) fn options(&self) -> &SessionOptions {
        &self.options
    }

    /// What was chosen for the graph's budget, where it states one.
    #[must_use]
    pub fn chosen(&self) -> Option<&Chosen> {
        self.state.chosen.as_ref()
    }

    /// The adapter that it runs on.
    #[must_use]
    pub fn adapter(&self) -> &AdapterSummary {
        self.runner.gpu().adapter()
    }

    /// How many objects of each kind are alive on the device ([`Gpu::live_objects`]).
    #[must_use]
    pub fn live_objects(&self) -> BTreeMap<&'static str, usize> {
        self.runner.gpu().live_objects()
    }

    /// The current view.
    #[must_use]
    pub fn view(&self) -> &View {
        &self.state.view
    }

    /// The files that the picture depends on, as the last attempt to draw it used them: after a change of files that
    /// was refused, those of the refused state.
    #[must_use]
    pub fn dependencies(&self) -> &Dependencies {
        &self.dependencies
    }

    /// Moves the camera; what stays open in `camera` is fitted to the volumes.
    pub fn set_camera(&mut self, camera: &CameraDesc) {
        self.stand(Stance::Fitted(camera.clone()));
    }

    /// Moves the camera to exactly there.
    pub fn place_camera(&mut self, camera: Camera) {
        self.stand(Stance::Exact(camera));
    }

    fn stand(&mut self, stance: Stance) {
        self.state.view = stance.view(self.state.installation.plan());
        self.state.stance = stance;
    }

    /// Which adapter is opened where the device is lost from now on.
    pub fn set_adapter(&mut self, adapter: AdapterChoice) {
        self.options.adapter = adapter;
    }

    /// Draws a frame without reading it back.
    ///
    /// # Errors
    /// What a node or the device refused, and hazards that a shader ran into. A lost device is opened again first.
    pub fn draw(&mut self) -> Result<FrameReport, Findings> {
        self.revive()?;
        match self.frame() {
            Err(_) if self.runner.gpu().lost().is_some() => {
                self.revive()?;
                self.frame()
            }
            drawn => drawn,
        }
    }

    fn frame(&mut self) -> Result<FrameReport, Findings> {
        let State {
            installation, view, ..
        } = &mut self.state;
        let mut report = self.runner.frame(installation, view)?;
        if installation.take_has_chosen() {
            self.runner.keep(installation, view);
            report.pipelines = self.runner.pipelines();
        }
        Ok(report)
    }

    /// Draws the frame and reads the output `color` back, with depth, opacity and layers where the session has them.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn render(&mut self) -> Result<(Picture, FrameReport), Findings> {
        let report = self.draw()?;
        match self.state.picture(&self.runner, self.options.with_layers) {
            Err(_) if self.runner.gpu().lost().is_some() => {
                let report = self.draw()?;
                Ok((
                    self.state.picture(&self.runner, self.options.with_layers)?,
                    report,
                ))
            }
            picture => Ok((picture?, report)),
        }
    }

    /// As [`Self::render`], held to what [`Self::apply`] asks of a picture: no hazard, and finite colours.
    ///
    /// # Errors
    /// As [`Self::draw`], the hazards that are warnings there, and `not-finite`.
    pub fn render_checked(&mut self) -> Result<(Picture, FrameReport), Findings> {
        let checked = self.render().and_then(|(picture, report)| {
            proof::check_hazards(&report)?;
            proof::check_finite(&picture, self.plan())?;
            Ok((picture, report))
        });
        match &checked {
            Ok(_) => self.state.is_proven = true,
            Err(findings) => {
                self.refused_files = Some(findings.clone());
                self.refused = Some(findings.clone());
            }
        }
        checked
    }

    /// Why the device was lost and opened again since this was last asked, if it was.
    pub fn take_device_remade(&mut self) -> Option<String> {
        self.remade.take()
    }

    /// Destroys the device, as a crash of its driver would, to see what comes after: the next frame opens it again.
    pub fn lose_device(&self) {
        self.runner.gpu().destroy();
    }

    /// Opens the device again where it is lost, with what was drawn last. Another adapter may have taken its place, for
    /// which the same files come to another plan.
    fn revive(&mut self) -> Result<(), Findings> {
        let Some(reason) = self.runner.gpu().lost() else {
            return Ok(());
        };
        let gpu = Arc::new(Gpu::open(&self.options.adapter)?);
        let limits = self.options.limits(&gpu);
        let state = &mut self.state;
        let mut plan = Arc::clone(state.installation.plan());
        let is_alike = gpu.capabilities() == self.runner.gpu().capabilities();
        if !is_alike {
            let roots = state.shaders.roots().clone();
            state.shaders = state
                .scene
                .shader_library(gpu.capabilities())
                .with_roots(roots);
        }
        if !is_alike || plan.limits != limits {
            let (size, with_layers) = (state.view.size, self.options.with_layers);
            plan = Arc::new(
                state
                    .scene
                    .plan(&state.shaders, &limits, size, with_layers)?,
            );
        }
        let mut runner = runner(gpu, &self.options);
        let installation = runner.prepare(plan, &state.view, None)?;
        self.runner = runner;
        state.installation = installation;
        self.remade = Some(reason);
        Ok(())
    }

    /// What a window shows of an output of the last frame, on the session's own device.
    ///
    /// # Errors
    /// Where there is no such output, or it is no colour, and what the device refused.
    pub fn display(&mut self, output: &str) -> Result<Shown, Findings> {
        Ok(self.runner.display(&self.state.installation, output)?)
    }

    /// Reads the texels of any output of the last frame, in 2D or 3D.
    ///
    /// # Errors
    /// Where there is no such output, and what the device refused.
    pub fn texels(&self, output: &str) -> Result<Texels, Findings> {
        Ok(self.runner.read(&self.state.installation, output)?)
    }

    /// Reads any 2D colour output of the last frame.
    ///
    /// # Errors
    /// Where there is no such output, or it is no colour.
    pub fn read(&self, output: &str) -> Result<Picture, Findings> {
        read(&self.runner, &self.state.installation, output)
    }
}

fn runner(gpu: Arc<Gpu>, options: &SessionOptions) -> Runner {
    Runner::new(gpu).keeping(KeptFiles::below(options.cache.as_ref()))
}

impl State {
    /// The picture of the last frame.
    fn picture(&self, runner: &Runner, has_layers: bool) -> Result<Picture, Findings> {
        picture(
            runner,
            &self.installation,
            &self.scene,
            &self.view,
            has_layers,
        )
    }
}
