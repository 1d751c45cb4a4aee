//! Runs plans: what must run, in its order, and nothing else.

mod bind;
mod frame;
mod schedule;
mod upload;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::Serialize;
use volgraph_graph::{Digest, NodeId, Plan, View};
use wgpu::{AddressMode, FilterMode, Sampler, SamplerDescriptor, Texture};

use crate::device::Gpu;
use crate::error::GpuError;
use crate::pipelines::Pipelines;
use crate::pool::{Held, PoolReport, Wish, make, match_wishes};
use crate::readback::{Texels, read_texture};

/// Samplers, made once.
#[derive(Debug)]
struct Samplers {
    linear: Sampler,
    nearest: Sampler,
    repeat: Sampler,
}

/// Runs the frames of one plan after the other on one device, and remembers what is done already.
pub struct Runner {
    gpu: Arc<Gpu>,
    plan: Option<Arc<Plan>>,
    /// One for each allocation of the plan, in its order.
    held: Vec<Held>,
    pipelines: Pipelines,
    samplers: Samplers,
    /// The target of draw passes, as large as the last view; nothing is written to it.
    scratch: Option<Texture>,
    /// Program → the variant that was measured to be the fastest, and the times.
    chosen: BTreeMap<Digest, (&'static str, BTreeMap<&'static str, f64>)>,
    made: u64,
    reused: u64,
}

/// What one frame did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrameReport {
    /// All nodes in their order.
    pub nodes: Vec<NodeReport>,
    /// Memory after the frame.
    pub memory: PoolReport,
    /// Pipelines built since the start.
    pub pipelines: usize,
}

/// What one node did in a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NodeReport {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Whether it ran, or what it wrote last still held.
    pub ran: bool,
    /// The variant that ran, where it has several.
    pub variant: Option<String>,
    /// The variants' times on the small view that chose among them, milliseconds.
    pub measured_ms: BTreeMap<String, f64>,
    /// Its time on the device, milliseconds; `None` where it did not run or the device cannot tell.
    pub gpu_ms: Option<f64>,
}

impl FrameReport {
    /// The names of the nodes that ran.
    #[must_use]
    pub fn ran(&self) -> Vec<&str> {
        self.nodes
            .iter()
            .filter(|node| node.ran)
            .map(|node| node.name.as_str())
            .collect()
    }
}

impl Runner {
    /// A runner without a plan.
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
            plan: None,
            held: Vec::new(),
            pipelines: Pipelines::default(),
            samplers,
            scratch: None,
            chosen: BTreeMap::new(),
            made: 0,
            reused: 0,
        }
    }

    /// The device.
    #[must_use]
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// The plan that runs.
    #[must_use]
    pub fn plan(&self) -> Option<&Arc<Plan>> {
        self.plan.as_ref()
    }

    /// Proves a plan and swaps it in: records it for its own view, builds every pipeline and every allocation
    /// inside error scopes, and only then lets go of the plan before. What that one held of use is taken over.
    ///
    /// # Errors
    /// What a node kind or the device refused; the plan before is then untouched.
    pub fn install(&mut self, plan: Arc<Plan>) -> Result<(), GpuError> {
        let view = plan.view();
        for &id in &plan.order {
            let Some(program) = &plan.graph.nodes[id].program else {
                continue;
            };
            for variant in self.variants_to_prove(&plan, id) {
                for pass in plan.record(id, &view, variant)? {
                    self.pipelines.get(&self.gpu, program, &pass)?;
                }
            }
        }
        let wishes = wishes(&plan, &view);
        let there: Vec<_> = self
            .held
            .iter()
            .map(|held| (held.resource, held.is_storage, held.content.clone()))
            .collect();
        let matched = match_wishes(&there, &wishes);
        let bytes = self.memory().bytes;
        let mut fresh = Vec::new();
        for (wish, at) in wishes.iter().zip(&matched) {
            fresh.push(match at {
                Some(_) => None,
                None => {
                    let what = format!("allocating {:?}", wish.resource);
                    Some(self.gpu.scoped(&what, bytes, || {
                        make(&self.gpu.device, wish.resource, wish.is_storage)
                    })?)
                }
            });
        }
        // From here on nothing can fail.
        let mut old: Vec<Option<Held>> = self.held.drain(..).map(Some).collect();
        for (fresh, at) in fresh.into_iter().zip(matched) {
            match (fresh, at.and_then(|at| old[at].take())) {
                (Some(held), _) => {
                    self.made += 1;
                    self.held.push(held);
                }
                (None, Some(held)) => {
                    self.reused += 1;
                    self.held.push(held);
                }
                // A wish is met by exactly one of the two.
                (None, None) => {}
            }
        }
        self.plan = Some(plan);
        Ok(())
    }

    /// Counts and bytes on the device.
    #[must_use]
    pub fn memory(&self) -> PoolReport {
        let textures = self
            .held
            .iter()
            .filter(|held| held.texture().is_some())
            .count();
        let scratch = self
            .scratch
            .as_ref()
            .map(|texture| u64::from(texture.width()) * u64::from(texture.height()));
        PoolReport {
            textures: textures + usize::from(scratch.is_some()),
            buffers: self.held.len() - textures,
            bytes: self
                .held
                .iter()
                .map(|held| held.resource.bytes())
                .sum::<u64>()
                + scratch.unwrap_or(0),
            made: self.made,
            reused: self.reused,
        }
    }

    /// Copies an output of the last frame to the host.
    ///
    /// # Errors
    /// [`GpuError::Output`] where there is no such output, and what the device refused.
    pub fn read(&self, output: &str) -> Result<Texels, GpuError> {
        let no_output = |reason: String| GpuError::Output {
            name: output.to_owned(),
            reason,
        };
        let Some(plan) = &self.plan else {
            return Err(no_output("no plan is installed".to_owned()));
        };
        let Some(link) = plan.graph.outputs.get(output) else {
            let known: Vec<&str> = plan.graph.outputs.keys().map(String::as_str).collect();
            return Err(no_output(format!(
                "the graph has no such output; it has {}",
                known.join(", ")
            )));
        };
        let Some(at) = plan.allocation_of.get(&(link.node, link.port.clone())) else {
            return Err(no_output("it is a source, not a picture".to_owned()));
        };
        read_texture(&self.gpu, &self.held[*at], output)
    }

    /// `[None]` for a node with one way to run; the chosen variant, or all of them before one is chosen.
    fn variants_to_prove(&self, plan: &Plan, id: NodeId) -> Vec<Option<&'static str>> {
        let variants = plan.variants(id);
        if variants.is_empty() {
            return vec![None];
        }
        match self.chosen_variant(plan, id) {
            Some((chosen, _)) if variants.contains(chosen) => vec![Some(*chosen)],
            _ => variants.into_iter().map(Some).collect(),
        }
    }

    fn chosen_variant(
        &self,
        plan: &Plan,
        id: NodeId,
    ) -> Option<&(&'static str, BTreeMap<&'static str, f64>)> {
        let program = plan.graph.nodes[id].program.as_ref()?;
        self.chosen.get(&program.module.linked.digest)
    }
}

fn wishes(plan: &Plan, view: &View) -> Vec<Wish> {
    let fingerprints = plan.fingerprints(view);
    let mut wishes: Vec<Wish> = plan
        .allocations
        .iter()
        .map(|allocation| Wish {
            resource: allocation.resource,
            is_storage: false,
            contents: BTreeSet::new(),
        })
        .collect();
    for ((id, port), allocation) in &plan.allocation_of {
        let wish = &mut wishes[*allocation];
        let binding = format!("{port}_out");
        wish.is_storage |= plan.graph.nodes[*id]
            .program
            .as_ref()
            .is_some_and(|program| program.uses(&binding));
        wish.contents.insert((fingerprints[id], port.clone()));
    }
    wishes
}
