//! Phase 2, demand: each node's shader is linked, and what its entry points use decides what else is made.
//!
//! For every node, needed by the outputs or not, the kind names its program; the [`ShaderLibrary`] links and checks it. A
//! binding that is really used and has the name of a demanded port calls for the node that fills it, unless the
//! file connects that port; equal demands share one node. A connected port whose binding nobody uses is let go,
//! so that culling can drop its writer. Nodes called for are treated in the same way, until nothing is missing.

mod call;
mod library;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use indexmap::IndexMap;
use volgraph_report::{Finding, Findings, Place};

use crate::desc::ParamDesc;
use crate::graph::{Graph, Link, Node, NodeBody, NodeId, Origin, Program, SlotChoice};
use crate::kind::{DerivedSlot, Inherited, InputPort, NodeKind, ProgramSpec, Requirement};
use crate::limits::Limits;
use crate::node_context::NodeContext;
use crate::registry::Registry;
use crate::resolve::default_slots;

pub(crate) use call::Call;
pub use library::{ShaderLibrary, ShaderTimes};

/// Links every node's shader, adds the nodes that used bindings call for and drops edges that no binding uses.
///
/// # Errors
/// All findings of the linker and of naga; `missing-entry` where a shader lacks an entry point; `missing-input`
/// where a used binding has no writer and cannot have one.
pub fn demand(
    mut graph: Graph,
    registry: &Registry,
    shaders: &ShaderLibrary,
    limits: &Limits,
) -> Result<Graph, Findings> {
    let mut findings = Findings::new();
    let mut made = Made::default();
    // Outputs wanted of a node decide its entry points, so readers are linked before writers.
    let mut is_done: Vec<bool> = vec![false; graph.nodes.len()];
    while let Some(id) = next_open(&graph, &is_done) {
        is_done[id] = true;
        let Some(kind) = graph.nodes[id].kind().cloned() else {
            continue;
        };
        for derived in kind.derived_slots() {
            if let Some(choice) = findings
                .take(stated(&graph.nodes[id], derived, shaders))
                .flatten()
                && let Some(slot) = graph.nodes[id].slots.get_mut(derived.slot)
            {
                slot.choice = choice;
            }
        }
        for (slot, choice) in open_choices(kind.as_ref(), &graph, id, limits) {
            if let Some(slot) = graph.nodes[id].slots.get_mut(slot) {
                choice.clone_into(&mut slot.choice);
            }
        }
        let Some(spec) = kind.program(&NodeContext::new(&graph, id, limits)) else {
            if call::settle(&mut graph, id, &mut made) {
                continue;
            }
            // Without a shader nothing is bound.
            let used = |_: &str| false;
            call_for(&mut graph, id, registry, &mut made, used, &mut findings);
            is_done.resize(graph.nodes.len(), false);
            continue;
        };
        let Some(program) = findings.take_all(program(&graph.nodes[id], spec, shaders)) else {
            continue;
        };
        graph.nodes[id].program = Some(program.clone());
        let mut specs = graph.nodes[id].specs();
        let context = NodeContext::new(&graph, id, limits);
        for spec in &mut specs {
            if let Some(default) = kind.default_of(&spec.name, &context) {
                spec.default = default;
            }
        }
        graph.nodes[id].fill_params(&specs);
        for inherited in &program.spec.inherited {
            inherit(&mut graph, id, &program, inherited);
        }
        if call::settle(&mut graph, id, &mut made) {
            continue;
        }
        call_for(
            &mut graph,
            id,
            registry,
            &mut made,
            |name| program.uses(name),
            &mut findings,
        );
        is_done.resize(graph.nodes.len(), false);
    }
    findings.into_result(graph)
}

/// What a kind chooses for slots that the graph leaves open.
fn open_choices(
    kind: &dyn NodeKind,
    graph: &Graph,
    id: NodeId,
    limits: &Limits,
) -> Vec<(&'static str, &'static str)> {
    let node = NodeContext::new(graph, id, limits);
    let open = kind
        .slots()
        .iter()
        .filter(|slot| !node.is_slot_given(slot.name));
    open.filter_map(|slot| Some((slot.name, kind.default_slot(slot.name, &node)?)))
        .collect()
}

/// The choice that another slot's file states for a slot that the graph leaves open.
fn stated(
    node: &Node,
    derived: &DerivedSlot,
    shaders: &ShaderLibrary,
) -> Result<Option<String>, Finding> {
    let is_open = |slot: &SlotChoice| slot.place.is_none();
    if !node.slots.get(derived.slot).is_some_and(is_open) {
        return Ok(None);
    }
    let slots = node.slots.iter();
    let slots = slots.map(|(name, slot)| (name.clone(), slot.choice.clone()));
    shaders.stated_choice(&slots.collect(), derived.from, derived.tag)
}

/// Takes over what the writer at a port was given. It is not linked yet, so its values are looked at here: one that
/// does not fit is reported where the writer itself is checked.
fn inherit(graph: &mut Graph, id: NodeId, program: &Program, inherited: &Inherited) {
    let (Some(file), Some(link)) = (
        program.module.linked.slots_used.get(inherited.slot),
        graph.nodes[id].inputs.get(inherited.port),
    ) else {
        return;
    };
    let writer = link.node;
    for spec in program.module.params() {
        let is_declared_there = spec.place.as_ref().is_some_and(|place| place.file == *file);
        if !is_declared_there || graph.nodes[id].given.contains_key(&spec.name) {
            continue;
        }
        let given = graph.nodes[writer].given.get(&spec.name);
        if let Some(value) = given.and_then(|given| spec.check(&given.value).ok()) {
            graph.nodes[id].params.insert(spec.name.clone(), value);
        }
    }
    for port in inherited.inputs {
        let theirs = graph.nodes[writer].inputs.get(*port).cloned();
        if let (Some(theirs), false) = (theirs, graph.nodes[id].inputs.contains_key(*port)) {
            let link = Link {
                place: None,
                ..theirs
            };
            graph.nodes[id].inputs.insert((*port).to_owned(), link);
        }
    }
}

/// A node that is not done and whose readers all are; any one where a cycle leaves no such node.
fn next_open(graph: &Graph, is_done: &[bool]) -> Option<NodeId> {
    let mut is_read = vec![false; graph.nodes.len()];
    for (reader, node) in graph
        .nodes
        .iter()
        .enumerate()
        .filter(|(reader, _)| !is_done[*reader])
    {
        for link in node.inputs.values().filter(|link| link.node != reader) {
            is_read[link.node] = true;
        }
    }
    let mut open = (0..graph.nodes.len()).filter(|id| !is_done[*id]);
    open.clone()
        .find(|id| !is_read[*id])
        .or_else(|| open.next())
}

fn program(node: &Node, spec: ProgramSpec, shaders: &ShaderLibrary) -> Result<Program, Findings> {
    let slots = node
        .slots
        .iter()
        .map(|(name, slot)| (name.clone(), slot.choice.clone()))
        .collect();
    let module = shaders
        .module(&spec, &slots)
        .map_err(|findings| at_choice(node, findings))?;
    let mut findings = Findings::new();
    let known = module.entry_points();
    let mut bindings = BTreeMap::new();
    for &entry in &spec.entries {
        if known.iter().any(|point| point.name == entry) {
            bindings.insert(entry, module.used_bindings(entry));
        } else {
            findings.push(module.missing_entry(entry));
        }
    }
    findings.into_result(Program {
        spec,
        module,
        bindings,
    })
}

/// A finding about a slot's choice without a place of its own stands where the graph makes that choice.
fn at_choice(node: &Node, findings: Findings) -> Findings {
    findings
        .into_iter()
        .map(|finding| {
            if finding.code != "unknown-choice" {
                return finding;
            }
            let choice = node.slots.values().find(|slot| {
                slot.place.is_some() && finding.message.contains(&format!("`{}`", slot.choice))
            });
            match choice.and_then(|slot| slot.place.clone()) {
                Some(place) => {
                    let finding = match finding.place.clone() {
                        Some(import) => finding.related(import, "imported here"),
                        None => finding,
                    };
                    finding.at(place)
                }
                None => finding,
            }
        })
        .collect()
}

fn call_for(
    graph: &mut Graph,
    id: NodeId,
    registry: &Registry,
    made: &mut Made,
    used: impl Fn(&str) -> bool,
    findings: &mut Findings,
) {
    let Some(kind) = graph.nodes[id].kind().cloned() else {
        return;
    };
    // What is made of all that the node has comes last.
    let is_alike = |port: &&InputPort| matches!(port.requirement, Requirement::DemandedAlike(_));
    let ports = kind.inputs().iter().filter(|port| !is_alike(port));
    for port in ports.chain(kind.inputs().iter().filter(is_alike)) {
        let is_bound = graph.nodes[id].program.is_some();
        match port.requirement {
            Requirement::Demanded(_) | Requirement::DemandedAlike(_) => {
                if !used(port.name) {
                    graph.nodes[id].inputs.remove(port.name);
                } else if !graph.nodes[id].inputs.contains_key(port.name) {
                    match fulfil(graph, id, port, registry, made) {
                        Ok(link) => {
                            graph.nodes[id].inputs.insert(port.name.to_owned(), link);
                        }
                        Err(finding) => findings.push(finding),
                    }
                }
            }
            // A texture that no entry point reads need not be made; what a node reads on the CPU or as a mesh stays.
            Requirement::Optional if is_bound && is_texture(port.ty) && !used(port.name) => {
                graph.nodes[id].inputs.remove(port.name);
            }
            Requirement::Optional | Requirement::Required => {}
        }
    }
}

fn is_texture(ty: crate::PortType) -> bool {
    use crate::PortType as P;
    matches!(
        ty,
        P::Color
            | P::Scalar2d
            | P::Vector2d
            | P::Trace
            | P::Table1d
            | P::Table2d
            | P::Pieces
            | P::Table3d
            | P::VolumeTexture
            | P::BrickPool
            | P::PageTable
            | P::ColorVolume
            | P::GradientTexture
            | P::LabelTexture
            | P::ImageTexture
            | P::BrickRanges
            | P::DistanceMap
            | P::BrickDetails
            | P::StrideMap
            | P::Spans
            | P::LightGrid
    )
}

/// The writer of a demanded port: an equal node that is there already, or a new one.
fn fulfil(
    graph: &mut Graph,
    id: NodeId,
    port: &InputPort,
    registry: &Registry,
    made: &mut Made,
) -> Result<Link, Finding> {
    let by = &graph.nodes[id];
    let place = graph.nodes[id].place(graph);
    let at = |finding: Finding| match &place {
        Some(place) => finding.at(place.clone()),
        None => finding,
    };
    let called = port.requirement.demanded_kind().unwrap_or_default();
    let unknown = || {
        let port = port.name;
        at(Finding::error(
            "unknown-kind",
            format!(
                "binding `{port}` calls for a node of kind `{called}`, which is not registered"
            ),
        ))
    };
    let kind = registry.node(called).ok_or_else(unknown)?;
    let call = Call::new(port.requirement, by, Some(kind.as_ref())).ok_or_else(unknown)?;
    let (port, ty) = (port.name, port.ty);
    let mut inputs = BTreeMap::new();
    for (theirs, mine) in &call.inputs {
        let Some(link) = by.inputs.get(mine) else {
            // Of several that may be left out, one is enough.
            if may_be_left_out(kind.as_ref(), theirs)
                && call.inputs.iter().any(|(theirs, mine)| {
                    may_be_left_out(kind.as_ref(), theirs) && by.inputs.contains_key(mine)
                })
            {
                continue;
            }
            let used_at = by.program.as_ref().and_then(|program| {
                program
                    .used()
                    .into_iter()
                    .find(|binding| binding.name == port)
                    .cloned()
            });
            let finding = at(Finding::error(
                "missing-input",
                format!("node `{}` needs its input `{mine}`: its shader uses `{port}`, which is made of it", by.name),
            )
            .help(format!("connect `{mine}`, or choose slots that do without it")));
            return Err(match used_at {
                Some(binding) => finding.related(binding.place, "used binding"),
                None => finding,
            });
        };
        inputs.insert(
            theirs.clone(),
            Link {
                place: None,
                ..link.clone()
            },
        );
    }
    let mut slots = default_slots(kind.as_ref());
    for (theirs, mine) in &call.slots {
        if let (Some(slot), Some(choice)) = (slots.get_mut(theirs), by.slots.get(mine)) {
            *slot = choice.clone();
        }
    }
    let mut given = IndexMap::new();
    for (theirs, mine) in &call.params {
        if let Some(value) = by.params.get(mine) {
            let place = by
                .given
                .get(mine)
                .map(|given| given.place.clone())
                .or_else(|| place.clone());
            let place = place.unwrap_or_else(|| Place::whole_file(""));
            let desc = ParamDesc {
                value: value.clone(),
                name_place: place.clone(),
                place,
            };
            given.insert(theirs.clone(), desc);
        }
    }
    let mut node = Node {
        name: String::new(),
        body: NodeBody::Kind(Arc::clone(kind)),
        inputs,
        given,
        // Its shader is not known yet; the kind may choose one by what is handed over.
        params: if call.is_alike {
            by.params.clone()
        } else {
            BTreeMap::new()
        },
        slots,
        origin: Origin::Demanded {
            by: id,
            binding: port.to_owned(),
        },
        program: None,
    };
    node.fill_params(&kind.params());
    let outputs = node.output_types();
    let output = outputs
        .iter()
        .find(|(_, output)| *output == ty)
        .or(outputs.first())
        .map(|(name, _)| (*name).to_owned())
        .unwrap_or_default();
    let link = |node| Link {
        node,
        port: output.clone(),
        place: None,
    };
    // What a node was called for with, not what it has become: its own shader adds inputs and parameters.
    let key = key(&node);
    if let Some(existing) = made.nodes.get(&key) {
        return Ok(link(*existing));
    }
    if made.nodes.len() >= MAX_DEMANDED {
        return Err(at(Finding::error(
            "too-large",
            format!("shaders call for more than {MAX_DEMANDED} nodes"),
        )
        .help(format!(
            "does kind `{}` call for itself with ever new inputs?",
            call.kind
        ))));
    }
    node.name = unique_name(graph, &format!("{}.{}", by.name, call.kind));
    graph.nodes.push(node);
    made.nodes.insert(key, graph.nodes.len() - 1);
    if call.is_alike {
        made.alike.insert(graph.nodes.len() - 1);
    }
    Ok(link(graph.nodes.len() - 1))
}

fn may_be_left_out(kind: &dyn NodeKind, port: &str) -> bool {
    kind.inputs()
        .iter()
        .any(|input| input.name == port && input.requirement == Requirement::Optional)
}

/// Most nodes that shaders may call for.
const MAX_DEMANDED: usize = 1024;

/// The nodes that were called for.
#[derive(Default)]
struct Made {
    /// By what they were called for with.
    nodes: BTreeMap<String, NodeId>,
    /// Those that were called for by equal names.
    alike: BTreeSet<NodeId>,
}

fn key(node: &Node) -> String {
    let inputs: Vec<_> = node
        .inputs
        .iter()
        .map(|(port, link)| (port, link.node, &link.port))
        .collect();
    let given: BTreeMap<_, _> = node
        .given
        .iter()
        .map(|(name, given)| (name, &given.value))
        .collect();
    let slots: Vec<_> = node
        .slots
        .iter()
        .map(|(slot, choice)| (slot, &choice.choice))
        .collect();
    format!("{:?}", (node.kind_name(), inputs, given, slots))
}

fn unique_name(graph: &Graph, wanted: &str) -> String {
    let mut name = wanted.to_owned();
    let mut count = 1;
    while graph.find(&name).is_some() {
        count += 1;
        name = format!("{wanted}_{count}");
    }
    name
}
