//! A plan with its memory on the device.

use std::collections::BTreeSet;
use std::sync::Arc;

use volgraph_graph::{NodeId, Plan, View};
use wgpu::Texture;

use super::Runner;
use super::frame::internal;
use crate::error::GpuError;
use crate::pool::{Held, PoolReport, Wish};
use crate::readback::{Texels, read_texture};

/// A plan that was proven on a device, and the memory that it runs in.
pub struct Installation {
    pub(super) plan: Arc<Plan>,
    /// One for each allocation of the plan, in its order.
    pub(super) held: Vec<Held>,
    /// The target of draw passes, as large as the last view; nothing is written to it.
    pub(super) scratch: Option<Texture>,
}

impl Installation {
    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &Arc<Plan> {
        &self.plan
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
        let plan = &installation.plan;
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
        let Some(at) = plan.allocation_of.get(&(link.node, link.port.clone())) else {
            return Err(no_output("it is a source, not a picture".to_owned()));
        };
        read_texture(&self.gpu, &installation.held[*at], output)
    }
}

/// What each allocation of a plan has to be, and would best hold already in this view.
pub(super) fn wishes(plan: &Plan, view: &View) -> Vec<Wish> {
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
