//! What every picture carries: enough to render it again and to see what has changed since.

use serde_json::json;
use volgraph_gpu::AdapterSummary;
use volgraph_graph::fingerprint::Hasher;
use volgraph_graph::{Plan, View, hex, print::CONVENTIONS};

use crate::scene::Scene;

/// The metadata of a picture: (key, value).
///
/// `version`, `graph.path`, `graph.text` and `graph.digest` (blake3 of the text), `overrides` (JSON), `size`,
/// `camera` (JSON), `adapter`, `digest.source.NAME` for every source that was drawn, `digest.shader.NODE` for
/// every linked shader (node names with dots as they are), and `convention.WHAT`.
#[must_use]
pub fn of(
    scene: &Scene,
    plan: &Plan,
    view: &View,
    adapter: &AdapterSummary,
) -> Vec<(String, String)> {
    let mut hasher = Hasher::new();
    hasher.part(scene.text.as_bytes());
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
    ];
    for node in &plan.graph.nodes {
        if let volgraph_graph::NodeBody::Source(source) = &node.body {
            metadata.push((key("digest.source", &node.name), hex(&source.digest())));
        }
        if let Some(program) = &node.program {
            metadata.push((
                key("digest.shader", &node.name),
                hex(&program.module.linked.digest),
            ));
        }
    }
    metadata.extend(
        CONVENTIONS
            .iter()
            .map(|(what, says)| (key("convention", what), (*says).to_owned())),
    );
    metadata
}

/// A key of a prefix and a name: letters, digits, `-`, `_` and `.`, 64 at most.
fn key(prefix: &str, name: &str) -> String {
    let name = name.chars().map(|c| {
        if c.is_ascii_alphanumeric() || "._-".contains(c) {
            c
        } else {
            '_'
        }
    });
    format!("{prefix}.").chars().chain(name).take(64).collect()
}
