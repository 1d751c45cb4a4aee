//! Looks at what a case speaks of, without a GPU.

use volgraph_graph::{GraphDesc, is_embedded, read};
use volgraph_report::{Finding, Findings, Place};

use super::kinds::Area;
use super::{Case, CaseOptions, Expectation, ExpectationKind, GraphName, Set, Sweep};
use crate::overrides::unknown;
use crate::{embedded, scene};

impl Case {
    /// Whether the graphs that it names are there and have the nodes, sources and slots that it sets. What is wrong
    /// within a graph is told where that is checked or rendered.
    #[must_use]
    pub fn check(&self) -> Findings {
        self.check_with(&CaseOptions::default())
    }

    /// The same, with shaders looked for where these options say.
    #[must_use]
    pub fn check_with(&self, options: &CaseOptions) -> Findings {
        let mut findings = Findings::new();
        let own = known_names(&self.graph, &mut findings);
        if let (Some(desc), false) = (&own, self.slots.is_empty()) {
            let node = desc.nodes.get(&self.node);
            if node.is_none() {
                let place = &self.slots[0].place;
                let finding = unknown(&self.node, place, desc.nodes.keys());
                findings.push(finding.help("name the node of the slots: `node: \"image\"`"));
            }
            findings.extend(self.check_slots(node.map(|node| node.kind.as_str()), options));
        }
        let mut settings: Vec<(&Option<GraphDesc>, &Set)> =
            self.set.iter().map(|set| (&own, set)).collect();
        if let Sweep::Product(axes) = &self.sweep {
            // A name that is wrong is told once, at the first of its values.
            settings.extend(axes.iter().filter_map(|axis| Some((&own, axis.first()?))));
        }
        let mut others = Vec::new();
        for expectation in self.expect.iter().chain(&self.once) {
            match &expectation.kind {
                ExpectationKind::Equals { other, .. }
                | ExpectationKind::Differs { other, .. }
                | ExpectationKind::NotSlower { than: other, .. } => {
                    let desc = other
                        .graph
                        .as_ref()
                        .map(|graph| known_names(graph, &mut findings));
                    others.push((desc, &other.set));
                }
                ExpectationKind::Halving { param, .. } | ExpectationKind::Order { param, .. } => {
                    if let Some(desc) = &own {
                        findings.extend(unknown_target(desc, &param.node, false, &param.place));
                    }
                }
                ExpectationKind::Pixel { at: Some(at), .. } => {
                    findings.extend(self.outside(*at, expectation));
                }
                ExpectationKind::Uniform { within, values, .. } => {
                    let area = within.unwrap_or(self.whole());
                    findings.extend(self.outside(area.last, expectation));
                    if values.is_empty() && area.first == area.last {
                        findings.push(
                            Finding::error(
                                "bad-value",
                                "this expectation cannot fail: one pixel is as itself",
                            )
                            .at(expectation.place.clone())
                            .help("give the value, `color: (r, g, b, a)`, or a larger area"),
                        );
                    }
                }
                ExpectationKind::Rolled {
                    quarters: 1 | 3, ..
                } if self.size[0] != self.size[1] => {
                    findings.push(
                        Finding::error(
                            "bad-value",
                            "a picture that is turned by a quarter is square",
                        )
                        .at(expectation.place.clone())
                        .help("give the case a square `size`, or roll by `quarters: 2`"),
                    );
                }
                _ => {}
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
        let is_picture = |expectation: &&Expectation| {
            matches!(expectation.kind, ExpectationKind::Picture { .. })
        };
        let has_points =
            self.sweep != Sweep::None || self.volumes.len() > 1 || self.cameras.len() > 1;
        for expectation in self.expect.iter().filter(is_picture).filter(|_| has_points) {
            findings.push(
                Finding::error("picture-of-many", "a stored picture is of one setting")
                    .at(expectation.place.clone())
                    .help("move it to `once: [ … ]`"),
            );
        }
        findings
    }

    /// All of its pictures.
    pub(super) fn whole(&self) -> Area {
        Area {
            first: [0, 0],
            last: self.size.map(|side| side.saturating_sub(1)),
        }
    }

    fn outside(&self, at: [u32; 2], expectation: &Expectation) -> Option<Finding> {
        let [width, height] = self.size;
        let message = format!("the picture has {width} × {height} pixels");
        (at[0] >= width || at[1] >= height).then(|| {
            Finding::error("outside", message)
                .at(expectation.place.clone())
                .help("columns and rows count from 0 at the top left")
        })
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
