//! One frame: recording and submitting the passes of the nodes that must run.

use std::collections::BTreeMap;
use std::sync::Arc;

use volgraph_graph::{Digest, NodeId, Pass, Plan, StateProgress, View};
use volgraph_report::{Finding, Findings};
use wgpu::{CommandEncoder, CommandEncoderDescriptor};

use super::schedule::must_run;
use super::variant::variant_key;
use super::{FrameReport, Installation, NodeReport, Runner};
use crate::error::GpuError;
use crate::guard::{Found, Watched};
use crate::pipelines::PipelineKind;
use crate::timing::Timer;

/// Commands recorded and not yet submitted.
pub(super) struct Recording {
    pub encoder: CommandEncoder,
    timer: Option<Timer>,
    watched: Watched,
    /// What went wrong in what was submitted.
    found: Found,
}

impl Recording {
    pub fn new(encoder: CommandEncoder, timer: Option<Timer>) -> Self {
        Self {
            encoder,
            timer,
            watched: Watched::default(),
            found: Found::new(),
        }
    }

    /// Everything that went wrong, where something did that leaves no picture.
    pub fn check(&self) -> Result<(), GpuError> {
        let all = self.found.iter().flat_map(|(_, findings)| findings);
        let all: Findings = all.cloned().collect();
        if all.has_errors() {
            return Err(all.into());
        }
        Ok(())
    }
}

impl Runner {
    /// Draws one frame and waits for it. Nodes whose result still holds do not run.
    ///
    /// # Errors
    /// What a node kind or the device refused; what the frame did not finish is then not remembered as done.
    pub fn frame(
        &mut self,
        installation: &mut Installation,
        view: &View,
    ) -> Result<FrameReport, GpuError> {
        let drawn = self.frame_here(installation, view);
        if drawn.is_err() {
            // What the device had to say beside that is of this frame, and must not be taken for the next one's.
            let _ = self.gpu.take_fault("drawing");
        }
        drawn
    }

    fn frame_here(
        &mut self,
        installation: &mut Installation,
        view: &View,
    ) -> Result<FrameReport, GpuError> {
        let plan = Arc::clone(&installation.plan);
        let fingerprints = plan.fingerprints(view);
        let contents: Vec<_> = installation
            .held
            .iter()
            .map(crate::pool::Held::content)
            .collect();
        let running = must_run(&plan, &fingerprints, &contents);
        let mut recording = Recording::new(self.encoder(), Timer::new(&self.gpu, running.len()));
        let mut written = Vec::new();
        let mut variants: BTreeMap<NodeId, &'static str> = BTreeMap::new();
        for &id in plan.order.iter().filter(|id| running.contains(id)) {
            // Until the whole frame has succeeded, nobody may rely on what is overwritten here.
            for ((_, port), allocation) in plan
                .allocation_of
                .range((id, String::new())..(id + 1, String::new()))
            {
                installation.held[*allocation].set_content(None);
                written.push((*allocation, (fingerprints[&id], port.clone())));
            }
            let variant = self.variant(installation, id, view, &mut recording)?;
            if let Some(variant) = variant {
                variants.insert(id, variant);
            }
            if let Some(timer) = &mut recording.timer {
                timer.mark(&mut recording.encoder);
            }
            self.node(installation, id, view, variant, &mut recording)?;
            if let Some(timer) = &mut recording.timer {
                timer.mark(&mut recording.encoder);
            }
        }
        if let Some(timer) = &recording.timer {
            timer.resolve(&mut recording.encoder);
        }
        self.settle(&mut recording)?;
        recording.check()?;
        let times = match &recording.timer {
            Some(timer) => timer.milliseconds(&self.gpu)?,
            None => Vec::new(),
        };
        for (allocation, content) in written {
            installation.held[allocation].set_content(Some(content));
        }
        let ran: Vec<Digest> = running.iter().map(|id| fingerprints[id]).collect();
        installation.remember(&plan, &fingerprints, &ran, recording.found);
        let mut times = times.into_iter();
        let mut warnings = Findings::new();
        let mut progress = StateProgress::default();
        let mut abouts: BTreeMap<NodeId, String> = BTreeMap::new();
        for &id in &plan.order {
            if let Some(state) = plan.state(id, view) {
                progress.ready += state.progress.ready;
                progress.wanted += state.progress.wanted;
                warnings.extend(state.warnings);
                abouts.insert(id, state.about);
            }
        }
        let nodes = plan
            .order
            .iter()
            .filter(|id| !plan.graph.nodes[**id].is_source())
            .map(|id| {
                let node = &plan.graph.nodes[*id];
                let ran = running.contains(id);
                let measured = installation
                    .chosen
                    .get(&variant_key(&plan, *id))
                    .map(|chosen| &chosen.measured);
                NodeReport {
                    name: node.name.clone(),
                    kind: node.kind_name(),
                    ran,
                    variant: variants.get(id).map(|variant| (*variant).to_owned()),
                    measured_ms: measured
                        .filter(|_| variants.contains_key(id))
                        .map(|times| {
                            times
                                .iter()
                                .map(|(name, ms)| ((*name).to_owned(), *ms))
                                .collect()
                        })
                        .unwrap_or_default(),
                    gpu_ms: if ran { times.next() } else { None },
                    about: abouts.remove(id),
                }
            });
        Ok(FrameReport {
            nodes: nodes.collect(),
            memory: self.memory(installation),
            pipelines: self.pipelines.len(),
            hazards: installation.hazards(&plan, &fingerprints),
            warnings,
            progress,
        })
    }

    pub(super) fn encoder(&self) -> CommandEncoder {
        self.gpu
            .device
            .create_command_encoder(&CommandEncoderDescriptor {
                label: Some("frame"),
            })
    }

    /// Submits what is recorded, waits for it, and takes note of what the guards have seen.
    pub(super) fn settle(&self, recording: &mut Recording) -> Result<(), GpuError> {
        let watched = std::mem::take(&mut recording.watched);
        let counters = watched.resolve(&self.gpu, &mut recording.encoder);
        self.flush(recording);
        self.gpu.wait()?;
        if let Some(counters) = &counters {
            recording
                .found
                .extend(watched.findings(&self.gpu, counters)?);
        }
        Ok(())
    }

    fn flush(&self, recording: &mut Recording) {
        let encoder = std::mem::replace(&mut recording.encoder, self.encoder());
        self.gpu.queue.submit([encoder.finish()]);
    }

    pub(super) fn node(
        &mut self,
        installation: &mut Installation,
        id: NodeId,
        view: &View,
        variant: Option<&'static str>,
        recording: &mut Recording,
    ) -> Result<(), GpuError> {
        let plan = Arc::clone(&installation.plan);
        let name = &plan.graph.nodes[id].name;
        let mut bound_before = Vec::new();
        for pass in plan.record(id, view, variant)? {
            match &pass {
                Pass::Upload { port, bytes } => {
                    // Writes through the queue come before what is recorded but not submitted.
                    self.flush(recording);
                    let held = installation.output(id, port)?;
                    self.upload(held, bytes, name, installation.bytes())?;
                }
                Pass::Tiles { port, tiles } => {
                    self.flush(recording);
                    let held = installation.output(id, port)?;
                    self.write_tiles(held, tiles, name, installation.bytes())?;
                }
                Pass::Compute { .. } | Pass::ComputeIndirect { .. } => {
                    let bound =
                        self.bound(installation, id, view, variant, &pass, &mut bound_before)?;
                    if let Some(guard) = &bound.pipeline.guard {
                        recording.watched.note(guard, id, &mut recording.encoder);
                    }
                    if let PipelineKind::Compute(compute) = &bound.pipeline.kind {
                        let mut encoder = recording.encoder.begin_compute_pass(&Default::default());
                        encoder.set_pipeline(compute);
                        for (group, bind_group) in &bound.groups {
                            encoder.set_bind_group(*group, bind_group, &[]);
                        }
                        match &pass {
                            Pass::ComputeIndirect { workgroups, .. } => {
                                let held = installation
                                    .output(id, workgroups)
                                    .or_else(|_| installation.input(id, workgroups))?;
                                let buffer = held
                                    .buffer()
                                    .ok_or_else(|| internal(&plan, id, workgroups))?;
                                encoder.dispatch_workgroups_indirect(buffer, 0);
                            }
                            Pass::Compute { workgroups, .. } => {
                                let [x, y, z] = *workgroups;
                                encoder.dispatch_workgroups(x, y, z);
                            }
                            _ => {}
                        }
                    }
                }
                Pass::Draw { .. } => {
                    let bound =
                        self.bound(installation, id, view, variant, &pass, &mut bound_before)?;
                    if let Some(guard) = &bound.pipeline.guard {
                        recording.watched.note(guard, id, &mut recording.encoder);
                    }
                    self.draw(
                        installation,
                        id,
                        view,
                        &pass,
                        &bound,
                        &mut recording.encoder,
                    )?;
                }
            }
        }
        Ok(())
    }
}

/// An error of a node kind whose passes do not fit its ports.
pub(super) fn internal(plan: &Plan, id: NodeId, what: &str) -> GpuError {
    let name = &plan.graph.nodes[id].name;
    Finding::error("internal", format!("node `{name}`: `{what}` has no resource; the node kind records what its ports do not say"))
        .into()
}
