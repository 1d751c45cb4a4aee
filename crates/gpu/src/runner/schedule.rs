//! Which nodes must run in a frame: backwards from the outputs, and on to what that overwrites.

use std::collections::{BTreeMap, BTreeSet};

use volgraph_graph::{Digest, NodeId, Plan};

/// What each allocation holds: (writer's fingerprint, output port).
pub(super) type Contents = Vec<Option<(Digest, String)>>;

/// The nodes that must run so that every output holds what its fingerprint says.
///
/// A node runs where something needed of it is not held. Resources may share an allocation one after the other, so a
/// node that runs can destroy what a later user of the same memory left there; that one then has to run as well.
pub(super) fn must_run(
    plan: &Plan,
    fingerprints: &BTreeMap<NodeId, Digest>,
    held: &Contents,
) -> BTreeSet<NodeId> {
    let mut held = held.clone();
    loop {
        let running = running(plan, fingerprints, &held);
        let mut is_stable = true;
        for id in &running {
            for ((_, port), allocation) in plan
                .allocation_of
                .range((*id, String::new())..(*id + 1, String::new()))
            {
                let own = (fingerprints[id], port.clone());
                if held[*allocation]
                    .as_ref()
                    .is_some_and(|content| *content != own)
                {
                    held[*allocation] = None;
                    is_stable = false;
                }
            }
        }
        if is_stable {
            return running;
        }
    }
}

fn running(
    plan: &Plan,
    fingerprints: &BTreeMap<NodeId, Digest>,
    held: &Contents,
) -> BTreeSet<NodeId> {
    let mut needed: BTreeSet<(NodeId, &str)> = plan
        .graph
        .outputs
        .values()
        .map(|link| (link.node, link.port.as_str()))
        .collect();
    let mut running = BTreeSet::new();
    for &id in plan.order.iter().rev() {
        let is_missing = plan
            .allocation_of
            .range((id, String::new())..(id + 1, String::new()))
            .any(|((_, port), allocation)| {
                needed.contains(&(id, port.as_str()))
                    && held[*allocation].as_ref() != Some(&(fingerprints[&id], port.clone()))
            });
        if is_missing {
            running.insert(id);
            needed.extend(
                plan.graph.nodes[id]
                    .inputs
                    .values()
                    .map(|link| (link.node, link.port.as_str())),
            );
        }
    }
    running
}
