//! What a demanded port calls for: the kind, and which inputs, parameters and slots go over from the node that calls.

use std::collections::BTreeSet;

use crate::graph::{Graph, Link, Node, NodeId};
use crate::kind::{NodeKind, Requirement};

use super::{Made, key};

/// A call for a node. Each pair names what the called node has, and what the calling node has for it.
pub(crate) struct Call {
    pub kind: &'static str,
    pub inputs: Vec<(String, String)>,
    pub params: Vec<(String, String)>,
    pub slots: Vec<(String, String)>,
    /// Whether it goes by equal names, so that more may be handed over than the called node takes.
    pub is_alike: bool,
}

impl Call {
    /// What a port of `by` calls for; `None` where it calls for nothing. `kind` is the kind that it calls for, if registered.
    pub fn new(requirement: Requirement, by: &Node, kind: Option<&dyn NodeKind>) -> Option<Self> {
        let pairs = |pairs: &[(&str, &str)]| {
            pairs
                .iter()
                .map(|(theirs, mine)| ((*theirs).to_owned(), (*mine).to_owned()))
                .collect()
        };
        let alike = |name: &str| (name.to_owned(), name.to_owned());
        match requirement {
            Requirement::Demanded(demand) => Some(Self {
                kind: demand.kind,
                inputs: pairs(demand.inputs),
                params: pairs(demand.params),
                slots: pairs(demand.slots),
                is_alike: false,
            }),
            Requirement::DemandedAlike(name) => Some(Self {
                kind: name,
                inputs: kind.map_or_else(Vec::new, |kind| {
                    // One that is required has to be there; the others go over where they are.
                    kind.inputs()
                        .iter()
                        .filter(|port| {
                            port.requirement == Requirement::Required
                                || by.inputs.contains_key(port.name)
                        })
                        .map(|port| alike(port.name))
                        .collect()
                }),
                params: by.params.keys().map(|name| alike(name)).collect(),
                slots: by.slots.keys().map(|name| alike(name)).collect(),
                is_alike: true,
            }),
            Requirement::Required | Requirement::Optional => None,
        }
    }
}

/// Once the shader of a node that was called for by equal names is linked: takes back what it does not declare, and
/// lets an equal node, where there is one, stand for it. Whether one does.
pub(super) fn settle(graph: &mut Graph, id: NodeId, made: &mut Made) -> bool {
    if !made.alike.contains(&id) {
        return false;
    }
    let node = &mut graph.nodes[id];
    let known: BTreeSet<String> = node.specs().into_iter().map(|spec| spec.name).collect();
    node.given.retain(|name, _| known.contains(name));
    node.params.retain(|name, _| known.contains(name));
    let key = format!("settled {}", key(node));
    let Some(equal) = made.nodes.get(&key).copied() else {
        made.nodes.insert(key, id);
        return false;
    };
    let links = graph
        .nodes
        .iter_mut()
        .flat_map(|node| node.inputs.values_mut());
    for link in links.chain(graph.outputs.values_mut()) {
        redirect(link, id, equal);
    }
    // What is left of it reads nothing, so nothing of it can be missing.
    let left = &mut graph.nodes[id];
    left.inputs.clear();
    left.given.clear();
    left.program = None;
    true
}

fn redirect(link: &mut Link, from: NodeId, to: NodeId) {
    if link.node == from {
        link.node = to;
    }
}
