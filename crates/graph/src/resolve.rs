//! Phase 1, resolve: names become kinds, nodes and ports; slots get their defaults.

use std::collections::BTreeMap;
use std::sync::Arc;

use indexmap::IndexMap;
use volgraph_report::{Finding, Findings, did_you_mean};
use volgraph_shader::ParamValue;

use crate::desc::{EdgeDesc, GraphDesc, NodeDesc};
use crate::graph::{Graph, Link, Node, NodeBody, Origin, SlotChoice};
use crate::kind::{NodeKind, Requirement};
use crate::plan::late::is_late;
use crate::registry::Registry;
use crate::source::Source;

/// Looks up every name. `sources` holds the loaded sources; one that could not be loaded is missing there, and its
/// readers are then not reported again.
///
/// # Errors
/// `unknown-kind`, `unknown-port`, `unknown-node`, `unknown-slot`, `missing-input`, `wrong-type` (of a slot).
pub fn resolve(
    desc: &GraphDesc,
    sources: &IndexMap<String, Arc<dyn Source>>,
    registry: &Registry,
) -> Result<Graph, Findings> {
    let mut findings = Findings::new();
    let mut graph = Graph::default();
    for (name, source) in sources {
        let origin = desc
            .sources
            .get(name)
            .map(|source| Origin::File(source.place.clone()));
        if let Some(origin) = origin {
            graph
                .nodes
                .push(node(name, NodeBody::Source(Arc::clone(source)), origin));
        }
    }
    for (name, node_desc) in &desc.nodes {
        let Some(kind) = registry.node(&node_desc.kind) else {
            findings.push(
                Finding::error(
                    "unknown-kind",
                    format!("unknown node kind `{}`", node_desc.kind),
                )
                .at(node_desc.kind_place.clone())
                .help_opt(did_you_mean(
                    &node_desc.kind,
                    registry.nodes().map(|kind| kind.name()),
                )),
            );
            continue;
        };
        let origin = Origin::File(node_desc.place.clone());
        let mut node = node(name, NodeBody::Kind(Arc::clone(kind)), origin);
        node.slots = slots(kind.as_ref(), node_desc, &mut findings);
        node.given = node_desc.params.clone();
        node.fill_params(&kind.params());
        graph.nodes.push(node);
    }
    for (name, node_desc) in &desc.nodes {
        if let Some(id) = graph.find(name) {
            let inputs = inputs(desc, &graph, id, node_desc, &mut findings);
            graph.nodes[id].inputs = inputs;
        }
    }
    for (name, edge) in desc.outputs.iter().filter(|(_, edge)| !is_late(edge)) {
        if let Some(link) = findings.take(link(desc, &graph, edge)).flatten() {
            graph.outputs.insert(name.clone(), link);
        }
    }
    findings.into_result(graph)
}

fn node(name: &str, body: NodeBody, origin: Origin) -> Node {
    Node {
        name: name.to_owned(),
        body,
        inputs: BTreeMap::new(),
        given: IndexMap::new(),
        params: BTreeMap::new(),
        slots: BTreeMap::new(),
        origin,
        program: None,
    }
}

/// The choices for all slots of a kind, with their defaults.
#[must_use]
pub(crate) fn default_slots(kind: &dyn NodeKind) -> BTreeMap<String, SlotChoice> {
    kind.slots()
        .iter()
        .map(|slot| {
            (
                slot.name.to_owned(),
                SlotChoice {
                    choice: slot.default.to_owned(),
                    place: None,
                },
            )
        })
        .collect()
}

fn slots(
    kind: &dyn NodeKind,
    desc: &NodeDesc,
    findings: &mut Findings,
) -> BTreeMap<String, SlotChoice> {
    let mut slots = default_slots(kind);
    for (name, given) in &desc.slots {
        let Some(slot) = slots.get_mut(name) else {
            findings.push(
                Finding::error(
                    "unknown-slot",
                    format!("node kind `{}` has no slot `{name}`", kind.name()),
                )
                .at(given.name_place.clone())
                .help_opt(did_you_mean(
                    name,
                    kind.slots().iter().map(|slot| slot.name),
                )),
            );
            continue;
        };
        match &given.value {
            ParamValue::Text(choice) => {
                *slot = SlotChoice {
                    choice: choice.clone(),
                    place: Some(given.place.clone()),
                };
            }
            _ => findings.push(
                Finding::error(
                    "wrong-type",
                    format!("slot `{name}` takes a name in quotes"),
                )
                .at(given.place.clone()),
            ),
        }
    }
    slots
}

fn inputs(
    desc: &GraphDesc,
    graph: &Graph,
    id: usize,
    node_desc: &NodeDesc,
    findings: &mut Findings,
) -> BTreeMap<String, Link> {
    let mut inputs = BTreeMap::new();
    let Some(kind) = graph.nodes[id].kind() else {
        return inputs;
    };
    for (port, edge) in &node_desc.inputs {
        if !kind.inputs().iter().any(|input| input.name == port) {
            findings.push(
                Finding::error(
                    "unknown-port",
                    format!("node kind `{}` has no input port `{port}`", kind.name()),
                )
                .at(edge.name_place.clone())
                .help_opt(did_you_mean(
                    port,
                    kind.inputs().iter().map(|input| input.name),
                )),
            );
        }
        if let Some(link) = findings.take(link(desc, graph, edge)).flatten() {
            inputs.insert(port.clone(), link);
        }
    }
    for input in kind.inputs() {
        if input.requirement == Requirement::Required && !node_desc.inputs.contains_key(input.name)
        {
            findings.push(
                Finding::error(
                    "missing-input",
                    format!(
                        "node `{}` needs its input `{}`: {}",
                        graph.nodes[id].name, input.name, input.doc
                    ),
                )
                .at(node_desc.place.clone())
                .help(format!(
                    "add `in: {{ \"{}\": \"…\" }}` with a writer of type {}",
                    input.name, input.ty
                )),
            );
        }
    }
    inputs
}

/// The writer that an edge names; `Ok(None)` where the writer itself has been reported already.
fn link(desc: &GraphDesc, graph: &Graph, edge: &EdgeDesc) -> Result<Option<Link>, Finding> {
    let (name, port) = match edge.from.split_once('.') {
        Some((name, port)) => (name, Some(port)),
        None => (edge.from.as_str(), None),
    };
    let Some(id) = graph.find(name) else {
        if desc.nodes.contains_key(name) || desc.sources.contains_key(name) {
            return Ok(None);
        }
        let known = desc
            .nodes
            .keys()
            .chain(desc.sources.keys())
            .map(String::as_str);
        return Err(Finding::error(
            "unknown-node",
            format!("no node or source is named `{name}`"),
        )
        .at(edge.place.clone())
        .help_opt(did_you_mean(name, known)));
    };
    let types = graph.nodes[id].output_types();
    let found = match port {
        Some(port) => types.iter().find(|(name, _)| *name == port),
        None => types.first(),
    };
    match found {
        Some((port, _)) => Ok(Some(Link {
            node: id,
            port: (*port).to_owned(),
            place: Some(edge.place.clone()),
        })),
        None => Err(Finding::error(
            "unknown-port",
            format!("`{name}` has no output port `{}`", port.unwrap_or_default()),
        )
        .at(edge.place.clone())
        .help_opt(did_you_mean(
            port.unwrap_or_default(),
            types.iter().map(|(name, _)| *name),
        ))),
    }
}
