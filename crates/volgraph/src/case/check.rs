//! Looks at what a case speaks of, without a GPU.

use volgraph_graph::{GraphDesc, is_embedded, read};
use volgraph_report::{Finding, Findings, Place};

use super::{Case, ExpectationKind, GraphName, Set};
use crate::overrides::unknown;
use crate::{embedded, scene};

impl Case {
    /// Whether the graphs that it names are there and have the nodes and sources that it sets. What is wrong within a
    /// graph is told where that is checked or rendered.
    #[must_use]
    pub fn check(&self) -> Findings {
        let mut findings = Findings::new();
        let own = known_names(&self.graph, &mut findings);
        let mut settings: Vec<(&Option<GraphDesc>, &Set)> =
            self.set.iter().map(|set| (&own, set)).collect();
        let mut others = Vec::new();
        for expectation in &self.expect {
            match &expectation.kind {
                ExpectationKind::Equals { other, .. } | ExpectationKind::Differs { other, .. } => {
                    let desc = other
                        .graph
                        .as_ref()
                        .map(|graph| known_names(graph, &mut findings));
                    others.push((desc, &other.set));
                }
                ExpectationKind::Halving { param, .. } => {
                    if let Some(desc) = &own {
                        findings.extend(unknown_target(desc, &param.node, false, &param.place));
                    }
                }
                ExpectationKind::Finite | ExpectationKind::StagesAgree { .. } => {}
            }
        }
        for (desc, sets) in &others {
            settings.extend(sets.iter().map(|set| (desc.as_ref().unwrap_or(&own), set)));
        }
        for (desc, set) in settings {
            if let Some(desc) = desc {
                let (target, is_slot) = (&set.value.target, set.value.is_slot);
                findings.extend(unknown_target(desc, target, !is_slot, &set.place));
            }
        }
        findings
    }
}

/// A graph's nodes and sources; `None` where it is not there (a finding) or cannot be read (told elsewhere).
fn known_names(graph: &GraphName, findings: &mut Findings) -> Option<GraphDesc> {
    if let Err(finding) = graph_is_there(graph) {
        findings.push(finding);
        return None;
    }
    let text = scene::read_text(&graph.path).ok()?;
    read::graph(&graph.path, &text).ok()
}

/// A case's graph is a file: a name alone does not stand for a ready graph here, so that a missing file is told.
fn graph_is_there(graph: &GraphName) -> Result<(), Finding> {
    let is_there = if is_embedded(&graph.path) {
        embedded::text(&graph.path).is_some()
    } else {
        graph.path.is_file()
    };
    if is_there {
        return Ok(());
    }
    let message = format!("there is no graph {}", graph.path.display());
    Err(Finding::error("missing-graph", message)
        .at(graph.place.clone())
        .help("name it from the case's own folder, or as `embedded:/graphs/NAME.ron`"))
}

fn unknown_target(
    desc: &GraphDesc,
    name: &str,
    may_be_source: bool,
    place: &Place,
) -> Option<Finding> {
    let is_known =
        desc.nodes.contains_key(name) || may_be_source && desc.sources.contains_key(name);
    let known = desc.nodes.keys().chain(desc.sources.keys());
    (!is_known).then(|| unknown(name, place, known))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    #[test]
    fn graphs_and_names_that_are_not_there_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let graph = embedded::text(Path::new("embedded:/graphs/quickstart.ron")).unwrap();
        fs::write(folder.path().join("g.ron"), graph).unwrap();
        let text = "(test: 1, graph: \"g.ron\", set: [\"imag.step=1\", \"colors.path=\\\"x\\\"\"], expect: [\n\
            equals(graph: \"no.ron\", max: 1),\nequals(graph: \"quickstart\", max: 1),\n\
            equals(graph: \"embedded:/graphs/hydrogen.ron\", set: [\"molecule.n=1\", \"glow.path=1\"], max: 1),\n\
            equals(graph: \"embedded:/graphs/no.ron\", max: 1),\n\
            halving(param: \"colors.step\", rmse: 1),\n])";
        let case = Case::parse(&folder.path().join("c.ron"), text).unwrap();
        let findings = case.check();
        let told: Vec<_> = findings
            .sorted()
            .iter()
            .map(|finding| (finding.code, finding.place.as_ref().unwrap().line))
            .collect();
        assert_eq!(
            told,
            [
                ("unknown-node", 1),
                ("missing-graph", 2),
                ("missing-graph", 3),
                ("unknown-node", 4),
                ("missing-graph", 5),
                ("unknown-node", 6)
            ],
            "{findings}"
        );
    }
}
