//! A plan with its memory on the device.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use volgraph_graph::{Digest, NodeId, Plan};
use volgraph_report::{Finding, Findings};
use wgpu::Texture;

use super::Runner;
use super::frame::internal;
use super::variant::Chosen;
use crate::error::GpuError;
use crate::guard::Found;
use crate::pool::{Held, PoolReport, Wish, Written};
use crate::readback::{Texels, read_texture};

/// A plan that was proven on a device, and the memory that it runs in.
pub struct Installation {
    pub(super) plan: Arc<Plan>,
    /// One for each allocation of the plan, in its order.
    pub(super) held: Vec<Held>,
    /// The target of draw passes, as large as the last view; nothing is written to it.
    pub(super) scratch: Option<Texture>,
    /// By [`super::variant::variant_key`]: an edit of a shader's text keeps the choice.
    pub(super) chosen: BTreeMap<String, Chosen>,
    /// Whether a variant was chosen since somebody asked.
    pub(super) has_chosen: bool,
    /// What went wrong while a result was made, by the fingerprint of the node that made it. As long as the result is
    /// held instead of made again, this stands too.
    pub(super) faults: BTreeMap<Digest, Findings>,
}

impl Installation {
    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    /// Whether a frame has chosen among variants since this was last asked. The pipelines of the others are then of no
    /// more use ([`Runner::keep`]).
    pub fn take_has_chosen(&mut self) -> bool {
        std::mem::take(&mut self.has_chosen)
    }

    /// Bytes that it holds on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let scratch = self.scratch.as_ref().map_or(0, |texture| {
            u64::from(texture.width()) * u64::from(texture.height())
        });
        scratch
            + self
                .held
                .iter()
                .map(|held| held.resource.bytes())
                .sum::<u64>()
    }

    /// Takes note of what went wrong in the results that a frame has made, those of the nodes that `ran`, and forgets
    /// what went wrong in results of other views.
    pub(super) fn remember(
        &mut self,
        plan: &Plan,
        fingerprints: &BTreeMap<NodeId, Digest>,
        ran: &[Digest],
        found: Found,
    ) {
        let current: BTreeSet<Digest> = plan.order.iter().map(|id| fingerprints[id]).collect();
        self.faults
            .retain(|made_by, _| current.contains(made_by) && !ran.contains(made_by));
        for (nodes, findings) in found {
            for id in nodes {
                let faults = self.faults.entry(fingerprints[&id]).or_default();
                faults.extend(findings.clone());
            }
        }
    }

    /// What went wrong in the results of this view, each once.
    pub(super) fn hazards(&self, plan: &Plan, fingerprints: &BTreeMap<NodeId, Digest>) -> Findings {
        let mut hazards: Vec<&Finding> = Vec::new();
        for id in &plan.order {
            for finding in self.faults.get(&fingerprints[id]).into_iter().flatten() {
                if !hazards.contains(&finding) {
                    hazards.push(finding);
                }
            }
        }
        hazards.into_iter().cloned().collect()
    }

    pub(super) fn output(&self, id: NodeId, port: &str) -> Result<&Held, GpuError> {
        let at = self
            .plan
            .allocation_of
            .get(&(id, port.to_owned()))
            .ok_or_else(|| internal(&self.plan, id, port))?;
        Ok(&self.held[*at])
    }

    pub(super) fn input(&self, id: NodeId, port: &str) -> Result<&Held, GpuError> {
        let link = self.plan.graph.nodes[id]
            .inputs
            .get(port)
            .ok_or_else(|| internal(&self.plan, id, port))?;
        self.output(link.node, &link.port)
    }
}

impl Installation {
    /// What the graph's output of that name lies in.
    pub(super) fn held_output(&self, output: &str) -> Result<&Held, GpuError> {
        let plan = &self.plan;
        let no_output = |reason: String| GpuError::Output {
            name: output.to_owned(),
            reason,
        };
        let Some(link) = plan.graph.outputs.get(output) else {
            let known: Vec<&str> = plan.graph.outputs.keys().map(String::as_str).collect();
            return Err(no_output(format!(
                "the graph has no such output; it has {}",
                known.join(", ")
            )));
        };
        match plan.allocation_of.get(&(link.node, link.port.clone())) {
            Some(at) => Ok(&self.held[*at]),
            None => Err(no_output("it is a source, not a picture".to_owned())),
        }
    }
}

impl Runner {
    /// Counts and bytes on the device of an installation, and counts of what was made since the start.
    #[must_use]
    pub fn memory(&self, installation: &Installation) -> PoolReport {
        let held = &installation.held;
        let textures = held.iter().filter(|held| held.texture().is_some()).count();
        PoolReport {
            textures: textures + usize::from(installation.scratch.is_some()),
            buffers: held.len() - textures,
            bytes: installation.bytes(),
            made: self.made,
            reused: self.reused,
        }
    }

    /// Copies an output of the installation's last frame to the host.
    ///
    /// # Errors
    /// [`GpuError::Output`] where there is no such output, and what the device refused.
    pub fn read(&self, installation: &Installation, output: &str) -> Result<Texels, GpuError> {
        let held = installation.held_output(output)?;
        read_texture(&self.gpu, &self.staging, held, output)
    }
}

/// What each allocation of a plan has to be, and would best hold already in the view of these fingerprints.
pub(super) fn wishes(plan: &Plan, fingerprints: &BTreeMap<NodeId, Digest>) -> Vec<Wish> {
    let mut wishes: Vec<Wish> = plan
        .allocations
        .iter()
        .map(|allocation| Wish {
            resource: allocation.resource,
            written: Written::default(),
            contents: BTreeSet::new(),
        })
        .collect();
    for ((id, port), allocation) in &plan.allocation_of {
        let wish = &mut wishes[*allocation];
        let binding = format!("{port}_out");
        let node = &plan.graph.nodes[*id];
        wish.written.is_storage |= node
            .program
            .as_ref()
            .is_some_and(|program| program.uses(&binding));
        wish.written.is_target |= node
            .kind()
            .is_some_and(|kind| kind.targets().contains(&port.as_str()));
        wish.written.is_tiled |= node
            .kind()
            .is_some_and(|kind| kind.tiled().contains(&port.as_str()));
        wish.contents.insert((fingerprints[id], port.clone()));
    }
    wishes
}
