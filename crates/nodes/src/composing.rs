//! What renderers share with the raycast that draw emission and absorption in their own way, and nothing else: inputs,
//! slots, parameters and uniforms, each under the raycast's name.

use std::sync::LazyLock;

use volgraph_graph::{InputPort, NodeContext, NodeKind, SlotSpec, Uniform};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;

use crate::raycast::{Raycast, check_lookup, check_walk, walk_slots};

const PORTS: [&str; 11] = [
    "volume",
    "transfer",
    "behind",
    "clip_volume",
    "volume_texture",
    "clip_volume_texture",
    "transfer_table",
    "preintegration_table",
    "preintegration_half_table",
    "integral_table",
    "preintegration_3d_table",
];

/// The inputs.
pub(crate) static INPUTS: LazyLock<Vec<InputPort>> = LazyLock::new(|| {
    let ports = Raycast.inputs().iter().copied();
    ports.filter(|port| PORTS.contains(&port.name)).collect()
});

/// The slots.
pub(crate) static SLOTS: LazyLock<Vec<SlotSpec>> = LazyLock::new(|| {
    let slots = Raycast.slots().iter().copied();
    slots
        .filter(|slot| ["reconstruct", "classify", "clip"].contains(&slot.name))
        .collect()
});

/// The parameters.
pub(crate) fn params() -> Vec<ParamSpec> {
    let not_here = ["stage", "brick_size", "label_boundary", "label_placement"];
    let params = Raycast.params().into_iter();
    params
        .filter(|spec| !not_here.contains(&spec.name.as_str()))
        .collect()
}

/// A uniform of the raycast.
pub(crate) fn uniform(name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    Raycast.uniform(name, node)
}

/// The choices of slots that the graph does not make: of the walk, of what is behind; no labels.
pub(crate) fn fixed_slots(node: &NodeContext<'_>) -> std::collections::BTreeMap<String, String> {
    let mut slots = walk_slots(node);
    let behind = if node.is_connected("behind") {
        "texture"
    } else {
        "none"
    };
    slots.insert("behind".to_owned(), behind.to_owned());
    slots.insert("labels".to_owned(), "none".to_owned());
    slots
}

/// Whether the picture behind fits and every walk comes to its end.
pub(crate) fn check(node: &NodeContext<'_>) -> Result<(), Finding> {
    check_walk(node)?;
    check_lookup(node)?;
    if node.is_connected("behind") && node.input_resource("behind") != node.output_resource("color")
    {
        return Err(node
            .error(
                "size-mismatch",
                "its input `behind` has another size or format than its output",
            )
            .help("make it as large as the picture, in rgba32float"));
    }
    Ok(())
}
