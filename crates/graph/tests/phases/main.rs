//! The phases from a graph file to a plan, each by itself, on small made-up kinds with shaders in memory.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod check;
mod cull_and_order;
mod demand;
mod fingerprint;
mod kinds;
mod read;
mod resolve;
mod size_and_lifetime;

use std::path::Path;
use std::sync::Arc;

use indexmap::IndexMap;
use naga::valid::Capabilities;
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{Folders, Graph, GraphDesc, Limits, NodeId, Plan, PlanRequest, Source};
use volgraph_report::Findings;

/// A graph's description and its loaded sources.
struct Loaded {
    desc: GraphDesc,
    sources: IndexMap<String, Arc<dyn Source>>,
}

fn load(text: &str) -> Loaded {
    let desc = volgraph_graph::read::graph(Path::new("g.ron"), text).unwrap();
    let (sources, findings) = volgraph_graph::sources::load(
        &desc,
        &kinds::registry(),
        &Folders::default(),
        &|_, _, _| {},
    );
    assert!(findings.is_empty(), "{findings}");
    Loaded { desc, sources }
}

/// A graph over the source `"f"` with these nodes and outputs.
fn graph_text(nodes: &str, outputs: &str) -> String {
    format!(
        "(\n  sources: {{ \"f\": field(seed: 1) }},\n  nodes: {{\n{nodes}\n  }},\n  outputs: {{ {outputs} }},\n)"
    )
}

fn library() -> ShaderLibrary {
    ShaderLibrary::new(kinds::shaders(), Capabilities::default(), None)
}

fn resolve(text: &str) -> Result<Graph, Findings> {
    let Loaded { desc, sources } = load(text);
    volgraph_graph::resolve::resolve(&desc, &sources, &kinds::registry())
}

fn demand(text: &str) -> Result<Graph, Findings> {
    volgraph_graph::demand::demand(
        resolve(text)?,
        &kinds::registry(),
        &library(),
        &Limits::default(),
    )
}

fn check(text: &str) -> Result<(), Findings> {
    volgraph_graph::check::check(&demand(text)?)
}

fn plan(text: &str, size: [u32; 2], limits: &Limits) -> Result<Plan, Findings> {
    let Loaded { desc, sources } = load(text);
    Plan::build(PlanRequest {
        desc: &desc,
        sources: &sources,
        registry: &kinds::registry(),
        shaders: &library(),
        limits,
        size,
        extra_outputs: &[],
    })
}

/// What was found: (code, line), sorted by place.
fn codes(findings: &Findings) -> Vec<(&'static str, u32)> {
    findings
        .sorted()
        .iter()
        .map(|f| (f.code, f.place.as_ref().map_or(0, |place| place.line)))
        .collect()
}

/// The one finding there is.
fn only<T>(result: Result<T, Findings>) -> volgraph_report::Finding {
    let Err(findings) = result else {
        panic!("something must be found")
    };
    assert_eq!(findings.len(), 1, "{findings}");
    findings.into_iter().next().unwrap()
}

fn id(graph: &Graph, name: &str) -> NodeId {
    graph
        .find(name)
        .unwrap_or_else(|| panic!("no node `{name}` among {:?}", names(graph)))
}

fn names(graph: &Graph) -> Vec<&str> {
    graph.nodes.iter().map(|node| node.name.as_str()).collect()
}
