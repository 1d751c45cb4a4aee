//! Phase 4, cull: backwards from the outputs; what nothing needs is dropped.

use std::collections::{BTreeMap, BTreeSet};

use crate::graph::{Graph, NodeId, Origin};

/// Drops the nodes that no output needs. Gives the rest, in the same order, and the names of the dropped ones.
#[must_use]
pub fn cull(graph: &Graph) -> (Graph, Vec<String>) {
    let live = graph.live();
    let renumbered: BTreeMap<NodeId, NodeId> = live
        .iter()
        .enumerate()
        .map(|(new, old)| (*old, new))
        .collect();
    let mut kept = Graph::default();
    let mut dropped = Vec::new();
    for (id, node) in graph.nodes.iter().enumerate() {
        if !live.contains(&id) {
            dropped.push(node.name.clone());
            continue;
        }
        let mut node = node.clone();
        for link in node.inputs.values_mut() {
            link.node = renumbered[&link.node];
        }
        if let Origin::Demanded { by, binding } = &mut node.origin {
            // Equal demands share a node. Where the first that called for it is dropped, another one keeps it.
            if !live.contains(by)
                && let Some((reader, port)) = reader(graph, &live, id)
            {
                (*by, *binding) = (reader, port.to_owned());
            }
            *by = renumbered.get(by).copied().unwrap_or(0);
        }
        kept.nodes.push(node);
    }
    kept.outputs = graph.outputs.clone();
    for link in kept.outputs.values_mut() {
        link.node = renumbered[&link.node];
    }
    (kept, dropped)
}

/// The first live node that reads a node, and the port at which it does.
fn reader<'g>(graph: &'g Graph, live: &BTreeSet<NodeId>, id: NodeId) -> Option<(NodeId, &'g str)> {
    live.iter().find_map(|&reader| {
        let (port, _) = graph.nodes[reader]
            .inputs
            .iter()
            .find(|(_, link)| link.node == id)?;
        Some((reader, port.as_str()))
    })
}
