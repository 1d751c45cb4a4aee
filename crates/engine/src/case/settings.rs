//! The settings that a case's pictures are rendered with.

use std::path::Path;

use volgraph_graph::{GraphDesc, NodeDesc, read};
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::ParamValue;

use super::{Case, Param, Set};
use crate::{ParamOverride, scene};

impl Case {
    /// The settings that put the slots under test into their node.
    pub(super) fn slot_sets(&self) -> Result<Vec<Set>, Findings> {
        self.slots
            .iter()
            .map(|slot| {
                let param = Param {
                    node: self.node.clone(),
                    name: format!("slots.{}", slot.slot),
                    place: slot.place.clone(),
                };
                setting(&param, &slot.choice)
            })
            .collect()
    }
}

/// Where the graph leaves the stage open, it is not measured which one is faster: a figure that depends on the moment is
/// none.
pub(super) fn fixed_stages(graph: &Path) -> Result<Vec<Set>, Findings> {
    let desc = read::graph(graph, &scene::read_text(graph)?)?;
    let is_open = |node: &NodeDesc| match node.params.get("stage") {
        Some(given) => given.value == ParamValue::Text("auto".to_owned()),
        None => true,
    };
    staged_nodes(&desc)
        .into_iter()
        .filter(|(_, node)| is_open(node))
        .map(|(name, node)| stage_setting(name, "fragment", &node.place))
        .collect()
}

/// The nodes of a kind that runs in a fragment or in a compute shader.
pub(super) fn staged_nodes(desc: &GraphDesc) -> Vec<(&String, &NodeDesc)> {
    let registry = volgraph_nodes::registry();
    let has_stages = |node: &NodeDesc| {
        let specs = registry
            .node(&node.kind)
            .map(|kind| kind.params())
            .unwrap_or_default();
        let stage = specs.iter().find(|spec| spec.name == "stage");
        stage.is_some_and(|spec| {
            ["fragment", "compute"]
                .iter()
                .all(|stage| spec.choices().iter().any(|choice| choice == stage))
        })
    };
    desc.nodes
        .iter()
        .filter(|(_, node)| has_stages(node))
        .collect()
}

pub(super) fn stage_setting(node: &str, stage: &str, place: &Place) -> Result<Set, Findings> {
    let param = Param {
        node: node.to_owned(),
        name: "stage".to_owned(),
        place: place.clone(),
    };
    setting(&param, stage)
}

/// Of settings of the same thing the last one, so that pictures that are the same are known to be.
pub(super) fn last_of_each(sets: impl Iterator<Item = Set>) -> Vec<Set> {
    let mut last: Vec<Set> = Vec::new();
    for set in sets {
        let what = |set: &Set| {
            (
                set.value.target.clone(),
                set.value.is_slot,
                set.value.name.clone(),
            )
        };
        last.retain(|before| what(before) != what(&set));
        last.push(set);
    }
    last.sort_by(|a, b| a.value.typed.cmp(&b.value.typed));
    last
}

/// A finding about a setting stands where the case has it, not on a command line that nobody typed.
pub(super) fn in_case(finding: Finding, sets: &[Set]) -> Finding {
    let file = finding.place.as_ref().map(|place| place.file.clone());
    let set = sets
        .iter()
        .find(|set| file.as_deref() == Some(Path::new(&format!("--set {}", set.value.typed))));
    match set {
        Some(set) => finding.at(set.place.clone()),
        None => finding,
    }
}

pub(super) fn setting(param: &Param, value: &str) -> Result<Set, Findings> {
    let typed = format!("{}.{}={value}", param.node, param.name);
    let value = ParamOverride::parse(&typed)
        .map_err(|message| Finding::error("bad-set", message).at(param.place.clone()))?;
    Ok(Set {
        value,
        place: param.place.clone(),
    })
}
