//! Outputs of nodes that shaders have called for.

use volgraph_report::{Finding, Findings, did_you_mean};

use crate::desc::{EdgeDesc, GraphDesc};
use crate::graph::Graph;

/// Whether an output may name a node which shaders call for: `node.binding.port`. Such nodes are there only once the
/// shaders have been asked.
pub(crate) fn is_late(edge: &EdgeDesc) -> bool {
    edge.from.matches('.').count() > 1
}

/// Links outputs to nodes that shaders have called for.
pub(super) fn link_late(graph: &mut Graph, desc: &GraphDesc) -> Result<(), Findings> {
    let mut findings = Findings::new();
    for (name, edge) in desc.outputs.iter().filter(|(_, edge)| is_late(edge)) {
        let ports = graph.nodes.iter().enumerate().flat_map(|(id, node)| {
            let types = node.output_types().into_iter();
            types.map(move |(port, _)| (id, port, format!("{}.{port}", node.name)))
        });
        let ports: Vec<_> = ports.collect();
        let link = ports.iter().find(|(_, _, full)| *full == edge.from);
        match link {
            Some((id, port, _)) => {
                let link = crate::Link {
                    node: *id,
                    port: (*port).to_owned(),
                    place: Some(edge.place.clone()),
                };
                graph.outputs.insert(name.clone(), link);
            }
            None => findings.push(
                Finding::error(
                    "unknown-port",
                    format!("nothing is written as `{}`", edge.from),
                )
                .at(edge.place.clone())
                .help_opt(did_you_mean(
                    &edge.from,
                    ports.iter().map(|(_, _, full)| full.as_str()),
                )),
            ),
        }
    }
    findings.into_result(())
}
