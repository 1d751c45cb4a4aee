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

#[cfg(test)]
mod tests {
    use std::fs;

    use volgraph_engine::{NoProgress, Overrides, ParamOverride, ShaderFolders, registry};

    use super::*;

    const GRAPH: &str = r#"// A ball, for a test.
(
    sources: { "volume": analytic(field: "sphere", dims: (8, 8, 8)), "colors": transfer(path: "colors.ron") },
    nodes: {
        "background": (kind: "background"),
        "box": (kind: "proxy_box", in: { "volume": "volume" }),
        "image": (kind: "raycast",
                  in: { "volume": "volume", "transfer": "colors", "rays": "box", "behind": "background" },
                  params: { "step": 1.0 /* whole voxels */ }),
    },
    outputs: { "color": "image.color" },
)
"#;
    const COLORS: &str = r##"(points: [(at: 0, color: "#000000", opacity: 0), (at: 1, color: "#ffffff", opacity: 0.5)])"##;

    fn scene(folder: &Path, sets: &[&str]) -> Scene {
        fs::write(folder.join("colors.ron"), COLORS).unwrap();
        let graph = folder.join("graph.ron");
        fs::write(&graph, GRAPH).unwrap();
        let params = sets.iter().map(|set| ParamOverride::parse(set).unwrap());
        let overrides = Overrides {
            params: params.collect(),
            look: Some("image.color".to_owned()),
            ..Overrides::default()
        };
        let loaded = Scene::load(
            &graph,
            &overrides,
            &ShaderFolders::default(),
            registry(),
            &NoProgress,
        );
        loaded.unwrap_or_else(|findings| panic!("{findings}"))
    }

    #[test]
    fn values_and_camera_go_into_the_file_and_its_comments_stay() {
        let folder = tempfile::tempdir().unwrap();
        let scene = scene(
            folder.path(),
            &["image.step=0.25", "image.slots.light=phong"],
        );
        let said = write(&scene, None, Some(CameraDesc::default()), &scene.path).unwrap();
        assert!(said.starts_with("Wrote "), "{said}");
        let text = fs::read_to_string(&scene.path).unwrap();
        for part in [
            "// A ball, for a test.",
            "0.25 /* whole voxels */",
            "phong",
            "camera:",
        ] {
            assert!(text.contains(part), "{part} in {text}");
        }
        // What is only looked at is no part of the graph.
        assert!(!text.contains("look"), "{text}");
        // Written again, nothing is left to write: the file is another by now.
        let stale = write(&scene, None, None, &scene.path).unwrap_err();
        assert!(stale.to_string().contains("changed-meanwhile"), "{stale}");
    }

    #[test]
    fn a_transfer_function_under_edit_is_not_named_by_the_viewers_file() {
        let folder = tempfile::tempdir().unwrap();
        let plain = scene(folder.path(), &[]);
        let mut edit = TransferEdit::of(&plain).unwrap();
        let mut points = edit.points();
        points[1].opacity = 0.75;
        let requests = edit.set_points(&points);
        let [crate::Request::Set(sets)] = requests.as_slice() else {
            panic!("{requests:?}");
        };
        let typed: Vec<&str> = sets.iter().map(|set| set.typed.as_str()).collect();
        let edited = scene(folder.path(), &[typed[0], "image.step=0.5"]);
        write(&edited, Some(&edit), None, &edited.path).unwrap();
        let text = fs::read_to_string(&edited.path).unwrap();
        assert!(
            text.contains("colors.ron") && text.contains("0.5 /*"),
            "{text}"
        );
    }
}
