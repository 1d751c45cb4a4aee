//! Finds a cycle and names it as people follow data: from writer to reader.

use volgraph_report::Finding;

use crate::graph::{Graph, NodeId, Origin};

/// The first cycle, if there is one, named along its edges.
pub(super) fn cycle(graph: &Graph) -> Option<Finding> {
    let found = cyclic_path(graph)?;
    // The path goes from reader to writer; people read it the way the data would go.
    let mut names: Vec<&str> = found
        .iter()
        .rev()
        .map(|id| graph.nodes[*id].name.as_str())
        .collect();
    names.push(names[0]);
    let mut finding = Finding::error(
        "cycle",
        format!("the nodes form a cycle: {}", names.join(" → ")),
    )
    .help("let one of them read from a node outside of the cycle");
    let places = found
        .iter()
        .filter_map(|id| match &graph.nodes[*id].origin {
            Origin::File(place) => Some((place.clone(), graph.nodes[*id].name.clone())),
            Origin::Demanded { .. } => None,
        });
    for (place, name) in places {
        if finding.place.is_none() {
            finding = finding.at(place);
        } else {
            finding = finding.related(place, format!("node `{name}`"));
        }
    }
    Some(finding)
}

/// The nodes of the first cycle, each a reader of the next. Without recursion: a chain may be as long as a file.
fn cyclic_path(graph: &Graph) -> Option<Vec<NodeId>> {
    let mut is_done = vec![false; graph.nodes.len()];
    let mut is_open = vec![false; graph.nodes.len()];
    for root in 0..graph.nodes.len() {
        // The path from the root, each node with the writers that are still to be visited.
        let mut path: Vec<(NodeId, Vec<NodeId>)> = Vec::new();
        let mut next = (!is_done[root]).then_some(root);
        loop {
            if let Some(id) = next {
                is_open[id] = true;
                path.push((
                    id,
                    graph.nodes[id]
                        .inputs
                        .values()
                        .rev()
                        .map(|link| link.node)
                        .collect(),
                ));
            }
            let Some((id, writers)) = path.last_mut() else {
                break;
            };
            next = writers.pop();
            match next {
                Some(writer) if is_open[writer] => {
                    let start = path.iter().position(|(id, _)| *id == writer).unwrap_or(0);
                    return Some(path[start..].iter().map(|(id, _)| *id).collect());
                }
                Some(writer) if is_done[writer] => next = None,
                Some(_) => {}
                None => {
                    (is_open[*id], is_done[*id]) = (false, true);
                    path.pop();
                }
            }
        }
    }
    None
}
