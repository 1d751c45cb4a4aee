//! The limit of a scene: its rays and samples and nothing else, as a scene of its own.

use volgraph_graph::NodeKind;
use volgraph_nodes::fetch_only::FetchOnly;
use volgraph_nodes::raycast::Raycast;
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::ParamValue;

use crate::overrides::ParamOverride;
use crate::scene::Scene;

/// What both kinds understand.
const INPUTS: [&str; 2] = ["volume", "rays"];
const PARAMS: [&str; 3] = ["step", "stage", "volume_storage"];

/// The name of the raycast that draws a scene's picture.
///
/// # Errors
/// `no-raycast`, where the output `color` is of something else.
pub fn raycast_of(scene: &Scene) -> Result<String, Finding> {
    let edge = scene.desc.outputs.get("color");
    let name = edge.map_or("", |edge| edge.from.split('.').next().unwrap_or_default());
    let kind = scene.desc.nodes.get(name).map(|node| node.kind.as_str());
    if kind == Some(Raycast.name()) || kind == Some(FetchOnly.name()) {
        return Ok(name.to_owned());
    }
    Err(Finding::error(
        "no-raycast",
        "the output `color` is of no raycast, whose samples could be taken alone",
    )
    .at(edge.map_or_else(|| Place::whole_file(&scene.path), |edge| edge.place.clone()))
    .help("name the port `color` of a raycast as the output `color`"))
}

/// The scene that takes the samples of another's raycast and adds them up: the same rays, step, storage and stage. What
/// the raycast skips or ends early, it takes all the same.
///
/// # Errors
/// Where the picture is of no raycast.
pub fn limit_of(scene: &Scene) -> Result<Scene, Findings> {
    let name = raycast_of(scene)?;
    let mut scene = scene.clone();
    if let Some(node) = scene.desc.nodes.get_mut(&name) {
        FetchOnly.name().clone_into(&mut node.kind);
        node.inputs
            .retain(|port, _| INPUTS.contains(&port.as_str()));
        node.params
            .retain(|param, _| PARAMS.contains(&param.as_str()));
        node.slots.clear();
    }
    scene.desc.quality = None;
    scene.desc.outputs.retain(|output, _| output == "color");
    Ok(scene)
}

/// The same with one sample a ray: what a frame of the limit costs without the others.
///
/// # Errors
/// As [`limit_of`].
pub fn empty_of(scene: &Scene) -> Result<Scene, Findings> {
    let name = raycast_of(scene)?;
    limit_of(scene)?.with_sets(&[set(&name, "samples", ParamValue::Int(0))])
}

/// A parameter of a node, as `--set` sets it.
pub(super) fn set(node: &str, param: &str, value: ParamValue) -> ParamOverride {
    ParamOverride {
        target: node.to_owned(),
        is_slot: false,
        name: param.to_owned(),
        typed: format!("{node}.{param}={value}"),
        value,
    }
}
