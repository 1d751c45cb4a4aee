//! A plan's nodes as they are printed: names instead of indices.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::check::{BindingSource, binding_source};
use crate::graph::NodeId;
use crate::plan::Plan;
use crate::resource::ResourceKind;

/// A node of a plan, for printing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedNode {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Input port → `node.port`.
    pub inputs: BTreeMap<String, String>,
    /// Parameter → value.
    pub params: BTreeMap<String, volgraph_shader::ParamValue>,
    /// Slot → choice, for the slots that its shader imports.
    pub slots: BTreeMap<String, String>,
    /// Entry point → the bindings that it uses, with what fills each.
    pub entries: BTreeMap<String, Vec<PlannedBinding>>,
    /// What it writes.
    pub outputs: Vec<PlannedResource>,
    /// The binding that called for it; `None` for a node of the file.
    pub called_for_by: Option<String>,
    /// Whether a moving camera makes it run again.
    pub follows_camera: bool,
}

/// A binding of a planned node.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedBinding {
    /// Its name.
    pub name: String,
    /// `@group`
    pub group: u32,
    /// `@binding`
    pub binding: u32,
    /// What fills it.
    pub source: BindingSource,
}

/// A resource of a planned node.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedResource {
    /// Output port.
    pub port: String,
    /// What it is.
    pub resource: ResourceKind,
    /// Index of its allocation.
    pub allocation: usize,
}

impl Plan {
    /// The nodes in their order, for printing.
    #[must_use]
    pub fn nodes(&self) -> Vec<PlannedNode> {
        self.order
            .iter()
            .filter(|id| !self.graph.nodes[**id].is_source())
            .map(|id| self.planned(*id))
            .collect()
    }

    fn planned(&self, id: NodeId) -> PlannedNode {
        let node = &self.graph.nodes[id];
        let name_of = |link: &crate::Link| {
            let writer = &self.graph.nodes[link.node];
            if writer.is_source() {
                writer.name.clone()
            } else {
                format!("{}.{}", writer.name, link.port)
            }
        };
        let entries = node
            .program
            .iter()
            .flat_map(|program| &program.bindings)
            .map(|(entry, bindings)| {
                let planned = bindings.iter().filter_map(|binding| {
                    Some(PlannedBinding {
                        name: binding.name.clone(),
                        group: binding.group,
                        binding: binding.binding,
                        source: binding_source(node, binding).ok()?,
                    })
                });
                ((*entry).to_owned(), planned.collect())
            });
        let imported = |slot: &str| {
            node.program
                .as_ref()
                .is_some_and(|program| program.module.linked.slots_used.contains_key(slot))
        };
        PlannedNode {
            name: node.name.clone(),
            kind: node.kind_name(),
            inputs: node
                .inputs
                .iter()
                .map(|(port, link)| (port.clone(), name_of(link)))
                .collect(),
            params: node.params.clone(),
            slots: node
                .slots
                .iter()
                .filter(|(slot, _)| imported(slot))
                .map(|(slot, choice)| (slot.clone(), choice.choice.clone()))
                .collect(),
            entries: entries.collect(),
            outputs: self
                .resources
                .range((id, String::new())..(id + 1, String::new()))
                .map(|((_, port), resource)| PlannedResource {
                    port: port.clone(),
                    resource: *resource,
                    allocation: self.allocation_of[&(id, port.clone())],
                })
                .collect(),
            called_for_by: match &node.origin {
                crate::Origin::Demanded { by, binding } => Some(format!(
                    "{} (binding {binding})",
                    self.graph.nodes[*by].name
                )),
                crate::Origin::File(_) => None,
            },
            follows_camera: self.following_camera.contains(&id),
        }
    }
}
