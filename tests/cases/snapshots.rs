//! The plan of each ready graph, as it is committed in `tests/plans`: what a graph allocates and binds is seen in a diff.
//!
//! `INSTA_UPDATE=always cargo test -p volgraph-tests snapshots` writes them anew. Where a graph draws a scan, which is no
//! part of volgraph, a small volume of bytes stands in for it.

use std::collections::BTreeSet;

use naga::valid::Capabilities;
use volgraph::{Limits, Overrides, Scene, ShaderFolders};
use volgraph_tests::repository::{graph_file, graphs, scans};
use volgraph_tests::{Stage, root};

/// The graphs, by name.
fn names() -> Vec<String> {
    let mut names = [graphs(), scans()].concat();
    names.sort();
    names
}

#[test]
fn the_plan_of_each_ready_graph_is_as_it_is_committed() {
    // All that a byte may be: something may be seen, and something may not.
    let bytes: Vec<u8> = (0..=255).flat_map(|byte| [byte; 2]).collect();
    let stage = Stage::new().with("stand_in_8x8x8_uint8.raw", bytes);
    let stand_in = stage.path().join("stand_in_8x8x8_uint8.raw");
    let names = names();
    for name in &names {
        let path = graph_file(name);
        let text = std::fs::read_to_string(&path).unwrap();
        let desc = volgraph_graph::read::graph(&path, &text).unwrap();
        let volumes = desc
            .sources
            .iter()
            .filter(|(_, source)| source.kind == "volume")
            .map(|(name, _)| (name.clone(), stand_in.clone()))
            .collect();
        let overrides = Overrides {
            volumes,
            ..Overrides::default()
        };
        let scene = Scene::load(
            &path,
            &overrides,
            &ShaderFolders::default(),
            volgraph::registry(),
            &volgraph::NoProgress,
        )
        .unwrap();
        let shaders = scene.shader_library(Capabilities::default());
        let plan = scene
            .plan(&shaders, &Limits::default(), [512, 512], false)
            .unwrap();
        // The conventions are the same in all; files have the paths of this machine.
        let folder = path.parent().unwrap().display().to_string();
        let text: Vec<String> = plan
            .to_text()
            .lines()
            .filter(|line| !line.starts_with("convention "))
            .map(|line| line.replace(&format!("{folder}/"), ""))
            .collect();
        insta::with_settings!({ snapshot_path => root().join("tests/plans"), prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(name.as_str(), text.join("\n"));
        });
    }
    // No snapshot of a graph that is gone.
    let known: BTreeSet<String> = names.iter().map(|name| format!("{name}.snap")).collect();
    for entry in std::fs::read_dir(root().join("tests/plans")).unwrap() {
        let file = entry.unwrap().file_name().into_string().unwrap();
        assert!(
            known.contains(&file),
            "tests/plans/{file} is of no ready graph"
        );
    }
}

#[test]
fn a_graph_without_shadows_clip_or_environment_plans_and_binds_nothing_for_them() {
    for name in names() {
        let plan =
            std::fs::read_to_string(root().join(format!("tests/plans/{name}.snap"))).unwrap();
        let graph = std::fs::read_to_string(graph_file(&name)).unwrap();
        for (slot, words) in [
            ("shadow", ["light_volume", "shadow"]),
            ("clip", ["clip_", "clip_volume"]),
            ("environment", ["environment", "environment_texture"]),
            ("labels", ["label_texture", "params_table"]),
        ] {
            if graph.contains(&format!("\"{slot}\":")) {
                continue;
            }
            let hits = plan.lines().filter(|line| {
                let line = line.trim_start();
                !line.starts_with("slot")
                    && !line.starts_with("param")
                    && words.iter().any(|word| line.contains(word))
            });
            let hits: Vec<&str> = hits.collect();
            assert!(hits.is_empty(), "{name} has no {slot}: {hits:?}");
        }
    }
}
