//! Runs plans: what must run, in its order, and nothing else.
//!
//! A [`Runner`] belongs to a device: pipelines, samplers. What belongs to a plan is an [`Installation`]: memory, which
//! variants are fastest, what its shaders did wrong. [`Runner::prepare`] proves the plan and gives it memory of its
//! own, sharing with the installation before only what already holds the right content and will not be written.
//! [`Runner::frame`] draws into an installation. The caller keeps the old one until a frame of the new one has
//! succeeded, drops the other, and calls [`Runner::keep`].

mod bind;
mod draw;
mod frame;
mod installation;
mod report;
mod schedule;
mod upload;
mod variant;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use volgraph_graph::{Digest, NodeId, Plan, View};
use wgpu::{AddressMode, FilterMode, Sampler, SamplerDescriptor};

use crate::device::Gpu;
use crate::display::{Display, Shown};
use crate::error::GpuError;
use crate::kept::{Keep, Kept};
use crate::pipelines::Pipelines;
use crate::pool::{Held, Wish, make, shared};
use crate::readback::Staging;

pub use installation::Installation;
use schedule::must_run;
use variant::{Chosen, variant_key};

pub use report::{FrameReport, NodeReport};

/// Samplers, made once.
#[derive(Debug)]
struct Samplers {
    linear: Sampler,
    nearest: Sampler,
    repeat: Sampler,
}

/// Runs installations of plans on one device, and remembers what is built already.
pub struct Runner {
    gpu: Arc<Gpu>,
    pipelines: Pipelines,
    samplers: Samplers,
    staging: Staging,
    display: Option<Display>,
    kept: Kept,
    made: u64,
    reused: u64,
}

/// What was built since the last [`Runner::take_building`], and how long it took.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Building {
    /// `node (entry point)` of each pipeline, in the order in which they were built.
    pub pipelines: Vec<String>,
    /// Time in the driver's pipeline builds.
    pub pipeline_time: Duration,
    /// Time for shader modules: guarding and wgpu's own validation.
    pub module_time: Duration,
}

impl Runner {
    /// A runner that has built nothing yet.
    #[must_use]
    pub fn new(gpu: Arc<Gpu>) -> Self {
        let sampler = |address: AddressMode, filter: FilterMode| {
            gpu.device.create_sampler(&SamplerDescriptor {
                address_mode_u: address,
                address_mode_v: address,
                address_mode_w: address,
                mag_filter: filter,
                min_filter: filter,
                ..SamplerDescriptor::default()
            })
        };
        let samplers = Samplers {
            linear: sampler(AddressMode::ClampToEdge, FilterMode::Linear),
            nearest: sampler(AddressMode::ClampToEdge, FilterMode::Nearest),
            repeat: sampler(AddressMode::Repeat, FilterMode::Linear),
        };
        Self {
            gpu,
            pipelines: Pipelines::default(),
            samplers,
            staging: Staging::default(),
            display: None,
            kept: Kept::default(),
            made: 0,
            reused: 0,
        }
    }

    /// The same, with a place for what is worth keeping between runs of the program; it looks there as well.
    #[must_use]
    pub fn keeping(mut self, keep: Option<Arc<dyn Keep>>) -> Self {
        self.kept = Kept(keep);
        self
    }

    /// The device.
    #[must_use]
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// What was built since the last call.
    pub fn take_building(&mut self) -> Building {
        std::mem::take(&mut self.pipelines.building)
    }

    /// How many pipelines are held.
    #[must_use]
    pub fn pipelines(&self) -> usize {
        self.pipelines.len()
    }

    /// Proves a plan for a view and for its own: records every pass, builds every pipeline and every allocation inside
    /// error scopes. What `before` holds of use in this very view is shared where a frame in this view will not write
    /// it, and so stays as it is when that frame is drawn.
    ///
    /// # Errors
    /// What a node kind or the device refused; `before` is untouched in any case.
    pub fn prepare(
        &mut self,
        plan: Arc<Plan>,
        view: &View,
        before: Option<&Installation>,
    ) -> Result<Installation, GpuError> {
        let mut chosen = before.map_or_else(BTreeMap::new, |before| before.chosen.clone());
        self.recall(&mut chosen, &plan);
        for &id in &plan.order {
            if plan.graph.nodes[id].program.is_none() {
                continue;
            }
            for variant in variants_to_prove(&chosen, &plan, id) {
                for view in views(&plan, view) {
                    for pass in plan.record(id, &view, variant)? {
                        self.pipelines.get(&self.gpu, &plan, id, &pass)?;
                    }
                }
            }
        }
        let fingerprints = plan.fingerprints(view);
        let wishes = installation::wishes(&plan, &fingerprints);
        let there: &[_] = before.map_or(&[], |before| &before.held);
        let bytes = before.map_or(0, Installation::bytes);
        let mut held = Vec::new();
        for (wish, at) in wishes
            .iter()
            .zip(unwritten(&plan, &fingerprints, there, &wishes))
        {
            held.push(match at {
                Some(at) => {
                    self.reused += 1;
                    there[at].clone()
                }
                None => {
                    let made = self.gpu.allocate(wish.resource, bytes, || {
                        make(&self.gpu.device, wish.resource, wish.written)
                    })?;
                    self.made += 1;
                    made
                }
            });
        }
        let scratch = before.and_then(|before| before.scratch.clone());
        let mut faults = before.map_or_else(BTreeMap::new, |before| before.faults.clone());
        faults.retain(|made_by, _| fingerprints.values().any(|it| it == made_by));
        Ok(Installation {
            plan,
            held,
            scratch,
            chosen,
            has_chosen: false,
            faults,
        })
    }

    /// Turns the colours of an installation's last frame into what windows show, in a texture of this device.
    ///
    /// # Errors
    /// [`GpuError::Output`] where the output is no picture, and what the device refused.
    pub fn display(
        &mut self,
        installation: &Installation,
        output: &str,
    ) -> Result<Shown, GpuError> {
        let held = installation.held_output(output)?;
        let display = match self.display.take() {
            Some(display) => display,
            None => Display::new(&self.gpu)?,
        };
        let display = self.display.insert(display);
        display.show(&self.gpu, held, output)
    }

    /// Lets go of every pipeline and shader module that this installation does not use in this view and in its own.
    pub fn keep(&mut self, installation: &Installation, view: &View) {
        let plan = &installation.plan;
        let mut used = Vec::new();
        for &id in &plan.order {
            if plan.graph.nodes[id].program.is_none() {
                continue;
            }
            for variant in variants_to_prove(&installation.chosen, plan, id) {
                for view in views(plan, view) {
                    // It has been recorded in these views before.
                    for pass in plan.record(id, &view, variant).into_iter().flatten() {
                        used.extend(crate::pipelines::key(plan, id, &pass));
                    }
                }
            }
        }
        self.pipelines.retain(&used);
        // What was dropped is freed now, and not when somebody waits for the next frame.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
    }
}

/// The views that passes are recorded for: a frame's, and the plan's own, in which variants are measured. A volume out
/// of view has other passes than one in view.
fn views(plan: &Plan, view: &View) -> Vec<View> {
    let own = plan.view();
    if own == *view {
        vec![own]
    } else {
        vec![own, *view]
    }
}

/// `[None]` for a node with one way to run; the chosen variant, or all of them before one is chosen.
fn variants_to_prove(
    chosen: &BTreeMap<String, Chosen>,
    plan: &Plan,
    id: NodeId,
) -> Vec<Option<&'static str>> {
    let variants = plan.variants(id);
    if variants.is_empty() {
        return vec![None];
    }
    match chosen.get(&variant_key(plan, id)) {
        Some(chosen) if variants.contains(&chosen.variant) => vec![Some(chosen.variant)],
        _ => variants.into_iter().map(Some).collect(),
    }
}

/// What each wish shares of what is there. A node of which one output is there and another is not runs, and would
/// write the shared one again while somebody else relies on it: it shares nothing.
fn unwritten(
    plan: &Plan,
    fingerprints: &BTreeMap<NodeId, Digest>,
    there: &[Held],
    wishes: &[Wish],
) -> Vec<Option<usize>> {
    let offers: Vec<_> = there
        .iter()
        .map(|held| (held.resource, held.written, held.content()))
        .collect();
    let mut taken = shared(&offers, wishes);
    let contents: Vec<_> = taken.iter().map(|at| there[(*at)?].content()).collect();
    let running = must_run(plan, fingerprints, &contents);
    for ((id, _), allocation) in &plan.allocation_of {
        if running.contains(id) && !wishes[*allocation].written.is_tiled {
            taken[*allocation] = None;
        }
    }
    taken
}
