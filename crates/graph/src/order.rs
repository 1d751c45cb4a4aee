//! Phase 5, order: writers before readers, ties by the order of the file, so that a graph has one order.

use crate::graph::{Graph, NodeId};

/// The order in which nodes run. The graph has no cycle (see [`crate::check`]).
#[must_use]
pub fn order(graph: &Graph) -> Vec<NodeId> {
    let mut order: Vec<NodeId> = Vec::with_capacity(graph.nodes.len());
    let mut is_done = vec![false; graph.nodes.len()];
    while order.len() < graph.nodes.len() {
        let next = (0..graph.nodes.len()).find(|&id| {
            !is_done[id]
                && graph.nodes[id]
                    .inputs
                    .values()
                    .all(|link| is_done[link.node])
        });
        let Some(next) = next else { break };
        is_done[next] = true;
        order.push(next);
    }
    order
}
