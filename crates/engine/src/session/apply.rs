//! Applying a change: link, validate, build inside error scopes, draw a frame, look at it, swap.
//!
//! A change becomes a whole [`State`] beside the one that works: a scene, a plan, an installation with memory of its
//! own, a frame drawn and a picture read back. Only when all of that has succeeded does it take the place of the
//! state before; else it is dropped, with its pipelines. Both ways end in the same clean-up, so that nothing stays
//! of what is not in use.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Instant;

use volgraph_gpu::{GpuError, Installation};
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{Plan, View};
use volgraph_picture::Picture;
use volgraph_report::Findings;
use volgraph_shader::{DiskFiles, SnapshotFiles};

use super::change::{Change, ChangeReport, Drawn, Outcome, Refused, ms};
use super::compare::{is_same, new_warnings, params, roles, unknown};
use super::proof::{check_finite, check_hazards};
use super::{Session, Stance, State, picture};
use crate::dependencies::Dependencies;
use crate::overrides::{Overrides, ParamOverride};
use crate::quality::{self, Chosen};
use crate::scene::{Scene, SourceProgress, read_text};

/// What was tried: a new state with its picture, or `None` where it would be the old one.
type Tried = Option<(State, Picture, Overrides)>;

/// A state that is planned, and not yet on the device.
struct Planned {
    scene: Scene,
    shaders: ShaderLibrary,
    snapshot: SnapshotFiles,
    plan: Arc<Plan>,
    stance: Stance,
    view: View,
    chosen: Option<Chosen>,
    wanted: Overrides,
}

impl Session {
    /// Applies a change and draws.
    ///
    /// # Errors
    /// Everything wrong with it; the session is then as it was before.
    pub fn apply(&mut self, change: &Change) -> Result<Outcome, Refused> {
        self.apply_with(change, &crate::scene::NoProgress)
    }

    /// The same, with the progress of sources that are read.
    ///
    /// # Errors
    /// As [`Self::apply`].
    pub fn apply_with(
        &mut self,
        change: &Change,
        progress: &dyn SourceProgress,
    ) -> Result<Outcome, Refused> {
        let mut report = ChangeReport::default();
        let whole = self.with_pending(change);
        let mut revived = self.revive();
        let mut tried = self.attempt(&whole, &mut report, progress);
        // Whether a device goes by the change's fault is only known when the next one goes as well.
        if tried.is_err() && revived.is_ok() && self.is_lost() {
            revived = self.revive();
            report = ChangeReport::default();
            tried = self.attempt(&whole, &mut report, progress);
            // What worked gets a new one at once.
            revived = revived.and_then(|()| self.revive());
        }
        let result = match (tried, revived) {
            (Ok(None), Ok(())) => Ok(Outcome::Unchanged),
            (Ok(Some((state, picture, wanted))), Ok(())) => {
                self.state = state;
                self.wanted = wanted;
                Ok(Outcome::Drawn(Box::new(Drawn { picture, report })))
            }
            (tried, revived) => {
                let mut findings = tried.err().unwrap_or_default();
                findings.extend(revived.err().unwrap_or_default());
                Err(findings)
            }
        };
        self.clean_up();
        self.conclude(whole, result)
    }

    /// Takes note of how a change ended.
    fn conclude(
        &mut self,
        change: Change,
        result: Result<Outcome, Findings>,
    ) -> Result<Outcome, Refused> {
        let is_repeat = match (&result, &change) {
            (Err(findings), Change::Files(_)) => {
                self.refused.as_ref() == Some(findings)
                    || self.refused_files.as_ref() == Some(findings)
            }
            (result, _) => result.as_ref().err() == self.refused.as_ref(),
        };
        self.refused = result.as_ref().err().cloned();
        if let Change::Files(changed) = change {
            self.refused_files = self.refused.clone();
            self.pending = match &self.refused {
                Some(_) => changed,
                None => BTreeSet::new(),
            };
        }
        match result {
            Ok(Outcome::Drawn(mut drawn)) => {
                drawn.report.device_remade = self.remade.take();
                drawn.report.frame.pipelines = self.runner.pipelines();
                Ok(Outcome::Drawn(drawn))
            }
            Ok(Outcome::Unchanged) => Ok(Outcome::Unchanged),
            Err(findings) => Err(Refused {
                findings,
                is_repeat,
                device_remade: self.remade.take(),
            }),
        }
    }

    fn is_lost(&self) -> bool {
        self.runner.gpu().lost().is_some()
    }

    /// A change of files with those of the changes that were refused since the last good one: what works has not seen
    /// them yet.
    fn with_pending(&self, change: &Change) -> Change {
        match change {
            Change::Files(changed) => Change::Files(changed | &self.pending),
            other => other.clone(),
        }
    }

    fn attempt(
        &mut self,
        change: &Change,
        report: &mut ChangeReport,
        progress: &dyn SourceProgress,
    ) -> Result<Tried, Findings> {
        let mut clock = Clock::start();
        let Some(planned) = self.look(change, report, progress, &mut clock)? else {
            return Ok(None);
        };
        // Nothing can be proven where there is no device.
        if let Some(reason) = self.runner.gpu().lost() {
            return Err(GpuError::Lost(reason).into());
        }
        let (installation, picture) = self.prove(&planned, report, &mut clock)?;
        if !matches!(change, Change::Files(_)) {
            let seen = Dependencies::of(&planned.scene, &planned.snapshot);
            if self.refused_files.is_none() {
                self.dependencies = seen;
            } else {
                // What may mend the files is still to be watched.
                self.dependencies.add(seen);
            }
        }
        let state = State {
            scene: planned.scene,
            shaders: planned.shaders,
            snapshot: planned.snapshot,
            installation,
            stance: planned.stance,
            view: planned.view,
            chosen: planned.chosen,
            is_proven: true,
        };
        Ok(Some((state, picture, planned.wanted)))
    }

    /// Everything that needs no device. `None` where the picture would be the same.
    fn look(
        &mut self,
        change: &Change,
        report: &mut ChangeReport,
        progress: &dyn SourceProgress,
        clock: &mut Clock,
    ) -> Result<Option<Planned>, Findings> {
        let mut wanted = self.wanted.clone();
        let sets: &[ParamOverride] = match change {
            Change::Set(sets) => sets,
            _ => &[],
        };
        set(&mut wanted.params, sets);
        if let Change::Look(look) = change {
            wanted.look.clone_from(look);
        }
        let old = &self.state;
        let snapshot = match change {
            Change::Files(_) => SnapshotFiles::new(Arc::new(DiskFiles)),
            _ => old.snapshot.fork(),
        };
        let scene = match change {
            Change::Files(changed) => {
                let text = read_text(&old.scene.path);
                let (path, data) = (&old.scene.path, &old.scene.data);
                let noted = &mut self.dependencies;
                noted.note(path, text.as_ref().ok(), changed, data, &snapshot);
                text.and_then(|text| old.scene.reload(text, changed, &wanted, progress, noted))
            }
            Change::Set(_) | Change::Look(_) => old.scene.with_overrides(&wanted, progress),
            // The overrides that are set aside stay aside.
            _ => old.scene.with_overrides(&old.scene.overrides, progress),
        };
        report.stages.read_ms = clock.lap();
        let mut scene = scene?;
        scene.check_color_output()?;
        let gpu = Arc::clone(self.runner.gpu());
        let shaders = old
            .shaders
            .with_roots(scene.shader_roots(Arc::new(snapshot.clone())));
        let settled = quality::settle(scene.clone(), &gpu, &self.options, old.chosen.as_ref());
        if let Ok((settled, _)) = &settled {
            scene = settled.clone();
        }
        let size = match change {
            Change::Size(size) => *size,
            _ => old.view.size,
        };
        let limits = self.options.limits(self.runner.gpu());
        let with_layers = self.options.with_layers;
        let mut plan = scene.plan(&shaders, &limits, size, with_layers);
        let gone = plan.as_ref().err().map(|findings| {
            let gone = unknown(&scene, findings).into_iter();
            // What is set by this very change has to be there.
            gone.filter(|gone| sets.iter().all(|set| !set.sets_the_same(gone)))
                .collect::<Vec<_>>()
        });
        if let Some(gone) = gone.filter(|gone| !gone.is_empty()) {
            let mut kept = scene.overrides.clone();
            kept.params.retain(|set| !gone.contains(set));
            scene = scene.with_overrides(&kept, progress)?;
            plan = scene.plan(&shaders, &limits, size, with_layers);
            let was_in_use = |set: &ParamOverride| old.scene.overrides.params.contains(set);
            let newly = gone.into_iter().filter(was_in_use);
            report.set_aside = newly.map(|set| set.typed).collect();
        }
        if let Change::Files(_) = change {
            self.dependencies = Dependencies::of(&scene, &snapshot);
        }
        let (_, chosen) = settled?;
        let times = shaders.take_times();
        report.stages.link_ms = ms(times.link);
        report.stages.validate_ms = ms(times.validate);
        report.stages.plan_ms = clock.lap() - ms(times.link) - ms(times.validate);
        let plan = Arc::new(plan?);

        report.chosen = chosen.clone().filter(|_| chosen != old.chosen);
        report.warnings = new_warnings(&old.scene, &scene);
        if let Change::Files(changed) = change {
            report.changed = roles(changed, &old.scene, &scene);
            if old.is_proven && report.warnings.is_empty() && is_same(old, &scene, &plan) {
                // Equal, but newer: what was looked at counts for what is looked at again.
                scene.share_sources(&old.scene);
                self.state.scene = scene;
                self.state.snapshot = snapshot;
                self.state.shaders = shaders;
                return Ok(None);
            }
        }
        params(old.installation.plan(), &plan, report);
        let stance = match change {
            Change::Camera(camera) => Stance::Fitted(camera.clone()),
            _ => old.stance.clone(),
        };
        let view = stance.view(&plan);
        Ok(Some(Planned {
            scene,
            shaders,
            snapshot,
            plan,
            stance,
            view,
            chosen,
            wanted,
        }))
    }

    /// Builds what is planned beside what works, draws it and looks at the picture.
    fn prove(
        &mut self,
        planned: &Planned,
        report: &mut ChangeReport,
        clock: &mut Clock,
    ) -> Result<(Installation, Picture), Findings> {
        let (plan, view) = (Arc::clone(&planned.plan), &planned.view);
        self.runner.take_building();
        let before = &self.state.installation;
        let installation = self.runner.prepare(plan, view, Some(before));
        let building = self.runner.take_building();
        report.stages.module_ms = ms(building.module_time);
        report.stages.pipeline_ms = ms(building.pipeline_time);
        report.stages.allocate_ms =
            clock.lap() - ms(building.module_time) - ms(building.pipeline_time);
        report.pipelines_built = building.pipelines;
        let mut installation = installation?;
        report.frame = self.runner.frame(&mut installation, view)?;
        report.stages.draw_ms = clock.lap();
        check_hazards(&report.frame)?;
        let picture = picture(
            &self.runner,
            &installation,
            &planned.scene,
            view,
            self.options.with_layers,
        )?;
        check_finite(&picture, &planned.plan)?;
        report.stages.read_back_ms = clock.lap();
        Ok((installation, picture))
    }

    /// Lets go of pipelines and modules that the current state does not use.
    pub(super) fn clean_up(&mut self) {
        self.runner.keep(&self.state.installation, &self.state.view);
        let used: BTreeSet<[u8; 32]> = self
            .state
            .installation
            .plan()
            .graph
            .nodes
            .iter()
            .filter_map(|node| Some(node.program.as_ref()?.module.linked.digest))
            .collect();
        self.state.shaders.keep(&used);
    }
}

/// Time between laps, in milliseconds.
struct Clock(Instant);

impl Clock {
    fn start() -> Self {
        Self(Instant::now())
    }

    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let lap = ms(now - self.0);
        self.0 = now;
        lap
    }
}

/// Sets values over those that were set before for the same names.
fn set(params: &mut Vec<ParamOverride>, sets: &[ParamOverride]) {
    for set in sets {
        params.retain(|before| !before.sets_the_same(set));
        params.push(set.clone());
    }
}

/// A library over the files as they are now.
pub(super) fn library(scene: &Scene, gpu: &volgraph_gpu::Gpu) -> (ShaderLibrary, SnapshotFiles) {
    let snapshot = SnapshotFiles::new(Arc::new(DiskFiles));
    let shaders = scene.shader_library(gpu.capabilities());
    let roots = scene.shader_roots(Arc::new(snapshot.clone()));
    (shaders.with_roots(roots), snapshot)
}
