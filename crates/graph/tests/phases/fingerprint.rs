//! What makes a node run again.

use volgraph_graph::{Digest, Limits, View, hex};

use crate::{graph_text, id, plan};

/// The fingerprint of a node, seen through a lens of this size and, if asked, from another place.
fn of(text: &str, node: &str, size: [u32; 2], is_moved: bool) -> Digest {
    let plan = plan(text, [64, 64], &Limits::default()).unwrap();
    let mut view = View {
        size,
        ..plan.view()
    };
    if is_moved {
        view.camera.eye.x += 1.0;
    }
    plan.fingerprints(&view)[&id(&plan.graph, node)]
}

fn text(light: &str, amount: &str, seed: u32) -> String {
    let nodes = format!(
        "\"q\": (kind: \"paint\"),\n\"p\": (kind: \"paint\", in: {{ \"volume\": \"f\", \"behind\": \"q\" }}, \
         slots: {{ \"light\": \"{light}\" }}, params: {{ \"amount\": {amount} }}),\n\
         \"h\": (kind: \"half\", in: {{ \"image\": \"p\" }}),\n\"o\": (kind: \"overlay\"),"
    );
    graph_text(&nodes, "\"color\": \"h\", \"over\": \"o\"")
        .replace("seed: 1", &format!("seed: {seed}"))
}

fn plain(text: &str, node: &str) -> Digest {
    of(text, node, [64, 64], false)
}

#[test]
fn the_same_work_has_the_same_fingerprint() {
    assert_eq!(
        plain(&text("flat", "1", 1), "p"),
        plain(&text("flat", "1", 1), "p")
    );
    // A name is not work.
    let named = text("over", "1", 1);
    let renamed = named.replace("\"q\"", "\"other\"");
    assert_eq!(plain(&named, "q"), plain(&renamed, "other"));
    assert_eq!(plain(&named, "h"), plain(&renamed, "h"));
    assert_eq!(hex(&plain(&text("flat", "1", 1), "p")).len(), 64);
}

#[test]
fn parameters_shaders_and_inputs_change_it_and_that_of_all_readers() {
    let before = text("tabled", "1", 1);
    for (what, after) in [
        ("a parameter", text("tabled", "1.5", 1)),
        ("the shader", text("flat", "1", 1)),
        ("the source", text("tabled", "1", 2)),
        ("an input", text("over", "1", 1)),
    ] {
        for node in ["p", "h"] {
            assert_ne!(
                plain(&before, node),
                plain(&after, node),
                "{what} of `{node}`"
            );
        }
        assert_eq!(
            plain(&before, "o"),
            plain(&after, "o"),
            "{what} is not `o`'s"
        );
    }
}

#[test]
fn the_view_changes_it_only_where_it_is_read() {
    let full = [64, 64];
    for (light, by_lens, by_pose) in [
        ("flat", false, false),
        ("lens", true, false),
        ("posed", false, true),
    ] {
        let text = text(light, "1", 1);
        let before = of(&text, "p", full, false);
        assert_eq!(
            of(&text, "p", [32, 64], false) != before,
            by_lens,
            "{light}: lens"
        );
        assert_eq!(
            of(&text, "p", full, true) != before,
            by_pose,
            "{light}: pose"
        );
        // Readers see it through their inputs.
        assert_eq!(
            of(&text, "h", full, true) != of(&text, "h", full, false),
            by_pose,
            "{light}: a reader"
        );
    }
}

#[test]
fn a_kind_without_a_shader_may_follow_the_camera_too() {
    let text = text("flat", "1", 1);
    let before = of(&text, "o", [64, 64], false);
    assert_ne!(of(&text, "o", [64, 64], true), before);
    assert_ne!(of(&text, "o", [32, 64], false), before);
}
