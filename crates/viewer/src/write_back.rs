//! Writing what was changed in the window into a graph file, with its comments and layout kept where nothing changed.

use std::path::Path;

use volgraph_engine::edits::{edited, moved, save_text};
use volgraph_engine::{CameraDesc, Findings, Overrides, Scene};

use crate::transfer::TransferEdit;

/// Writes the values that were set, and a camera, into the graph's own file or another one; what to say of it.
///
/// # Errors
/// Why nothing was written.
pub(crate) fn write(
    scene: &Scene,
    transfer: Option<&TransferEdit>,
    camera: Option<CameraDesc>,
    to: &Path,
) -> Result<String, Findings> {
    let mut overrides = Overrides {
        camera: camera.or_else(|| scene.overrides.camera.clone()),
        look: None,
        ..scene.overrides.clone()
    };
    // A transfer function under edit is saved into its own file, not named by the viewer's.
    let is_scratch = |target: &str, name: &str| {
        transfer.is_some_and(|edit| edit.is_changed() && edit.source == target && name == "path")
    };
    overrides
        .params
        .retain(|set| !is_scratch(&set.target, &set.name));
    let mut edits = overrides.edits(to, &scene.desc)?;
    if to != scene.path {
        let elsewhere = moved(&scene.text, &scene.path, to)?;
        // What was set counts more than where it was.
        edits.splice(0..0, elsewhere);
    }
    let text = edited(&scene.text, &scene.path, &edits, to)?;
    if to == scene.path && text == scene.text {
        return Ok(format!("{} holds all of it already.", to.display()));
    }
    let before = (to == scene.path).then_some(scene.text.as_str());
    save_text(to, before, &text)?;
    Ok(format!("Wrote {}.", to.display()))
}
