//! Phase 7, lifetime: which resources share memory.
//!
//! What does not follow the camera (tables, gradients, a background) is kept between frames, so that a moving
//! camera does not make it again. The rest is transient: a resource whose last reader has run gives its memory
//! to the next one of equal description. Outputs live to the end of the frame.

use std::collections::{BTreeMap, BTreeSet};

use crate::graph::{Graph, NodeId};
use crate::plan::Allocation;
use crate::size::Resources;

/// The nodes whose result changes when the camera moves: by their own shader or passes, or by an input.
#[must_use]
pub fn following_camera(graph: &Graph, order: &[NodeId]) -> BTreeSet<NodeId> {
    let mut following = BTreeSet::new();
    for &id in order {
        let node = &graph.nodes[id];
        let itself = node
            .program
            .as_ref()
            .is_some_and(|program| program.uses("camera"))
            || node.kind().is_some_and(|kind| kind.passes_follow_camera());
        if itself
            || node
                .inputs
                .values()
                .any(|link| following.contains(&link.node))
        {
            following.insert(id);
        }
    }
    following
}

/// Gives each resource its allocation: (node, port) → index of the allocation.
#[must_use]
pub fn lifetime(
    graph: &Graph,
    order: &[NodeId],
    resources: &Resources,
    following: &BTreeSet<NodeId>,
) -> (BTreeMap<(NodeId, String), usize>, Vec<Allocation>) {
    let position: BTreeMap<NodeId, usize> =
        order.iter().enumerate().map(|(at, id)| (*id, at)).collect();
    let mut last_read: BTreeMap<(NodeId, &str), usize> = BTreeMap::new();
    for (id, node) in graph.nodes.iter().enumerate() {
        for link in node.inputs.values() {
            let read = last_read
                .entry((link.node, link.port.as_str()))
                .or_default();
            *read = (*read).max(position[&id]);
        }
    }
    for link in graph.outputs.values() {
        last_read.insert((link.node, link.port.as_str()), usize::MAX);
    }
    let mut allocations: Vec<Allocation> = Vec::new();
    let mut busy_until: Vec<usize> = Vec::new();
    let mut assigned = BTreeMap::new();
    for (at, &id) in order.iter().enumerate() {
        for ((_, port), resource) in resources.range((id, String::new())..(id + 1, String::new())) {
            let is_tiled = graph.nodes[id]
                .kind()
                .is_some_and(|kind| kind.tiled().contains(&port.as_str()));
            let is_transient = following.contains(&id) && !is_tiled;
            let until = last_read.get(&(id, port.as_str())).copied().unwrap_or(at);
            let free = (0..allocations.len()).find(|&a| {
                is_transient
                    && allocations[a].is_transient
                    && allocations[a].resource == *resource
                    && busy_until[a] < at
            });
            let allocation = free.unwrap_or_else(|| {
                allocations.push(Allocation {
                    resource: *resource,
                    is_transient,
                    users: Vec::new(),
                });
                busy_until.push(0);
                allocations.len() - 1
            });
            busy_until[allocation] = until;
            allocations[allocation]
                .users
                .push(format!("{}.{port}", graph.nodes[id].name));
            assigned.insert((id, port.clone()), allocation);
        }
    }
    (assigned, allocations)
}
