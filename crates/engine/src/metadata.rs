//! What every picture carries: enough to render it again and to see what has changed since.

use std::fmt::Display;

use serde_json::json;
use volgraph_graph::fingerprint::Hasher;
use volgraph_graph::{Plan, View, hex, print::CONVENTIONS};

use crate::scene::Scene;

/// The metadata of a picture: (key, value).
///
/// `version`, `graph.path`, `graph.text` and `graph.digest` (blake3 of the text), `overrides` (JSON), `size`, `camera`
/// (JSON), `adapter` (who drew it), `shaders.folders` (JSON: the user's own folders of shaders), `digest.sources` and
/// `digest.shaders` (JSON: name of the source or node → blake3 of its content
/// or its linked text), and `conventions` (JSON).
#[must_use]
pub fn of(scene: &Scene, plan: &Plan, view: &View, adapter: &dyn Display) -> Vec<(String, String)> {
    let mut hasher = Hasher::new();
    hasher.part(scene.text.as_bytes());
    let own = scene.shader_folders.own.iter();
    let folders: serde_json::Value = own.map(|it| it.display().to_string()).collect();
    let mut metadata = vec![
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("graph.path".to_owned(), scene.path.display().to_string()),
        ("graph.text".to_owned(), scene.text.clone()),
        ("graph.digest".to_owned(), hex(&hasher.finish())),
        ("overrides".to_owned(), json!(scene.overrides).to_string()),
        (
            "size".to_owned(),
            format!("{}x{}", view.size[0], view.size[1]),
        ),
        ("camera".to_owned(), json!(view.camera).to_string()),
        ("adapter".to_owned(), adapter.to_string()),
        ("shaders.folders".to_owned(), folders.to_string()),
    ];
    let mut sources = serde_json::Map::new();
    let mut shaders = serde_json::Map::new();
    for node in &plan.graph.nodes {
        if let volgraph_graph::NodeBody::Source(source) = &node.body {
            sources.insert(node.name.clone(), json!(hex(&source.digest())));
        }
        if let Some(program) = &node.program {
            shaders.insert(node.name.clone(), json!(hex(&program.module.linked.digest)));
        }
    }
    metadata.push(("digest.sources".to_owned(), json!(sources).to_string()));
    metadata.push(("digest.shaders".to_owned(), json!(shaders).to_string()));
    let conventions: serde_json::Map<_, _> = CONVENTIONS
        .iter()
        .map(|(what, says)| ((*what).to_owned(), json!(says)))
        .collect();
    metadata.push(("conventions".to_owned(), json!(conventions).to_string()));
    metadata
}
