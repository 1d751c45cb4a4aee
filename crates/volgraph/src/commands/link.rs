//! `volgraph link`: one WGSL text of a shader and everything it imports.
//!
//! The way of the data: a `.wgsl` file is linked alone, with the default choice of each slot; with `--node KIND` it is
//! linked from that kind's own shader down, as the choice of its slot, as `volgraph check` does. A `.ron` file is a
//! graph, loaded as `volgraph check` loads it, and the text is that of one of its nodes. The text goes to standard
//! output even where naga finds errors in it; these go to standard error.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use naga::valid::Capabilities;
use volgraph::{Finding, Findings, Overrides, ParamOverride, Place, Registry, registry};
use volgraph_graph::{Node, demand, resolve};
use volgraph_report::{did_you_mean, list_names};
use volgraph_shader::{LinkRequest, Linked, ParamValue, link};

use super::check::{graphs, read};
use super::shader_tree::{Tree, slot_of, tree_of};
use crate::args::LinkArgs;
use crate::output;

pub fn run(args: &LinkArgs) -> anyhow::Result<ExitCode> {
    let registry = registry();
    let is_graph = args.file.extension().is_some_and(|ending| ending == "ron");
    let linked = if is_graph {
        of_graph(args, &registry)?
    } else {
        of_shader(args, &registry)?
    };
    if args.plain {
        output::print(&linked.text);
    } else {
        output::print(&linked.annotated());
    }
    volgraph_shader::check(linked, Capabilities::default())?;
    Ok(ExitCode::SUCCESS)
}

/// A shader alone, or in the shader of a node kind.
fn of_shader(args: &LinkArgs, registry: &Registry) -> Result<Arc<Linked>, Findings> {
    let tree = Tree::new(&tree_of(&args.file), registry, &args.shaders.folders());
    let mut request = match &args.node {
        Some(kind) => in_node(&args.file, kind, &tree)?,
        None => LinkRequest {
            slots: tree.slots.clone(),
            ..LinkRequest::new(&args.file)
        },
    };
    request.slots.extend(args.slots.iter().cloned());
    let linked = link(&tree.roots, &request.base(""))?;
    let mut findings = unused_slots(args, &linked);
    let file = std::fs::canonicalize(&args.file).unwrap_or_else(|_| args.file.clone());
    if let Some(kind) = &args.node
        && linked.files.iter().all(|linked| linked.resolved != file)
    {
        let message = format!("a node of kind `{kind}` with these slots does not import it");
        findings.push(
            Finding::error("not-imported", message)
                .at(Place::whole_file(&args.file))
                .help("name another kind with `--node`, other choices with `--slots`, or leave `--node` out"),
        );
    }
    findings.into_result(Arc::new(linked))
}

/// A kind's own shader with `file` as the choice of its slot.
fn in_node(file: &Path, kind: &str, tree: &Tree<'_>) -> Result<LinkRequest, Finding> {
    let Some(known) = tree.registry.node(kind) else {
        let kinds = tree.registry.nodes().map(|kind| kind.name());
        let message = format!("no kind of node is named `{kind}`");
        return Err(Finding::error("unknown-kind", message).help_opt(did_you_mean(kind, kinds)));
    };
    let Some((slot, _)) = slot_of(file) else {
        return tree.of_kind(known.as_ref()).ok_or_else(|| {
            Finding::error(
                "no-shader",
                format!("nodes of kind `{kind}` have no shader"),
            )
            .help("leave `--node` out, or name a kind that `volgraph nodes` shows slots for")
        });
    };
    let Some(request) = tree.importing(known.as_ref(), &slot) else {
        let kinds = tree.registry.nodes();
        let importers = kinds.filter(|kind| tree.importing(kind.as_ref(), &slot).is_some());
        let names: Vec<&str> = importers.map(|kind| kind.name()).collect();
        let message = format!("nodes of kind `{kind}` do not import the slot `{slot}`");
        let finding = Finding::error("not-imported", message).at(Place::whole_file(file));
        return Err(if names.is_empty() {
            finding.help("no kind does; leave `--node` out")
        } else {
            finding.help(format!("these kinds do: {}", list_names(names)))
        });
    };
    Ok(request.slot(slot, file.display().to_string()))
}

/// A choice that changes nothing is a slip.
fn unused_slots(args: &LinkArgs, linked: &Linked) -> Findings {
    let asked = || linked.slots_asked.keys().map(String::as_str);
    let unused = args
        .slots
        .iter()
        .filter(|(slot, _)| !linked.slots_asked.contains_key(slot));
    unused
        .map(|(slot, _)| {
            Finding::error(
                "unknown-slot",
                format!("nothing here imports the slot `{slot}`"),
            )
            .at(Place::whole_file(&args.file))
            .help_opt(did_you_mean(slot, asked()))
        })
        .collect()
}

/// A node of a graph.
fn of_graph(args: &LinkArgs, registry: &Registry) -> Result<Arc<Linked>, Findings> {
    let here = || Place::whole_file(&args.file);
    let name = args.node.as_deref().unwrap_or_default();
    let set = args.slots.iter().map(|(slot, choice)| ParamOverride {
        target: name.to_owned(),
        is_slot: true,
        name: slot.clone(),
        value: ParamValue::Text(choice.clone()),
        typed: format!("{name}.slots.{slot}={choice}"),
    });
    let overrides = Overrides {
        params: set.collect(),
        ..Overrides::default()
    };
    let checker = graphs::Checker {
        registry,
        folders: &args.shaders.folders(),
        data: &args.data.data,
    };
    let mut findings = Findings::new();
    let scene = checker.scene(&args.file, read(&args.file)?, overrides, &mut findings);
    let Some(scene) = scene else {
        return Err(findings);
    };
    if !findings.is_empty() {
        output::report(&findings);
    }
    let graph = resolve::resolve(&scene.desc, &scene.sources, registry)?;
    let shaders = scene.shader_library(Capabilities::default());
    let graph = demand::demand(graph, registry, &shaders, &graphs::limits())?;
    let has_shader = |node: &&Node| node.program.is_some();
    let shaded = || graph.nodes.iter().filter(has_shader);
    let Some(node) = shaded().find(|node| node.name == name) else {
        let names = || shaded().map(|node| node.name.as_str());
        let finding = match &args.node {
            None => Finding::error("node-unset", "a graph has many shaders").help(format!(
                "name a node with `--node`: {}",
                list_names(names())
            )),
            Some(name) if graph.find(name).is_some() => {
                Finding::error("no-shader", format!("`{name}` has no shader"))
                    .help(format!("these have: {}", list_names(names())))
            }
            Some(name) => Finding::error("unknown-node", format!("no node is named `{name}`"))
                .help_opt(did_you_mean(name, names())),
        };
        return Err(finding.at(here()).into());
    };
    let linked = node.program.as_ref().map(|program| &program.module.linked);
    linked.cloned().ok_or_else(Findings::new)
}
