//! What is different between what works and what is tried.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use volgraph_graph::Plan;
use volgraph_report::Findings;
use volgraph_shader::Linked;

use super::State;
use super::change::{ChangeReport, ChangedFile};
use crate::overrides::ParamOverride;
use crate::scene::Scene;

/// The overrides that these findings call unknown.
pub(super) fn unknown(scene: &Scene, findings: &Findings) -> Vec<ParamOverride> {
    let is_unknown = |set: &&ParamOverride| {
        findings.into_iter().any(|finding| {
            finding.code == "unknown-param" && finding.place.as_ref() == Some(&set.place())
        })
    };
    let params = scene.overrides.params.iter();
    params.filter(is_unknown).cloned().collect()
}

/// Whether the picture and its metadata would be the same.
pub(super) fn is_same(old: &State, scene: &Scene, plan: &Plan) -> bool {
    let contents = |scene: &Scene| -> Vec<_> {
        let sources = scene.sources.iter();
        sources
            .map(|(name, source)| (name.clone(), source.digest()))
            .collect()
    };
    let programs = |plan: &Plan| -> Vec<_> {
        let nodes = plan.graph.nodes.iter();
        nodes
            .map(|node| {
                let linked = node.program.as_ref().map(|program| &program.module.linked);
                // Findings name files, so the same text in another file is another program.
                let paths = |linked: &Linked| -> Vec<PathBuf> {
                    let files = linked.files.iter();
                    files.map(|file| file.path.clone()).collect()
                };
                (
                    node.name.clone(),
                    linked.map(|linked| (linked.digest, linked.slots_used.clone(), paths(linked))),
                )
            })
            .collect()
    };
    old.scene.text == scene.text
        && old.scene.overrides == scene.overrides
        && contents(&old.scene) == contents(scene)
        && programs(old.installation.plan()) == programs(plan)
}

/// What each changed file is to the picture.
pub(super) fn roles(changed: &BTreeSet<PathBuf>, old: &Scene, new: &Scene) -> Vec<ChangedFile> {
    let source_of = |path: &Path| {
        let mut sources = new.sources.iter().chain(&old.sources);
        sources
            .find(|(_, source)| source.files().iter().any(|file| file == path))
            .map(|(name, _)| name.clone())
    };
    let role = |path: &PathBuf| match source_of(path) {
        _ if *path == new.path => "graph".to_owned(),
        Some(source) => format!("source {source}"),
        None => "shader".to_owned(),
    };
    changed
        .iter()
        .map(|path| ChangedFile {
            path: path.clone(),
            role: role(path),
        })
        .collect()
}

/// What was added to and dropped from the parameters of nodes that both plans have.
pub(super) fn params(old: &Plan, new: &Plan, report: &mut ChangeReport) {
    let lacks = |plan: &Plan, node: &str, name: &str| {
        let found = plan.graph.nodes.iter().find(|other| other.name == node);
        found.is_some_and(|node| node.specs().iter().all(|spec| spec.name != name))
    };
    let missing = |from: &Plan, other: &Plan| {
        let mut missing = Vec::new();
        for node in &from.graph.nodes {
            for (name, value) in &node.params {
                if lacks(other, &node.name, name) {
                    missing.push(format!("{}.{name} = {value}", node.name));
                }
            }
        }
        missing
    };
    report.params_added = missing(new, old);
    report.params_dropped = missing(old, new);
}

pub(super) fn new_warnings(old: &Scene, new: &Scene) -> Vec<String> {
    let before = old.warnings();
    let now = new.warnings().into_iter();
    now.filter(|warning| !before.contains(warning))
        .map(|(source, warning)| format!("source {source}: {warning}"))
        .collect()
}
