//! `volgraph link`: the text of a shader with what it imports.

use crate::{SPHERE, Scratch, TRANSFER, copy, graph};

const OWN: &str = "// The scalar at a point: one.\n#import \"lib/ray.wgsl\"\n\
                   fn reconstruct_scalar(position: vec3f) -> f32 {\n    return 1.0;\n}\n";

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    copy("shaders", scratch.path());
    scratch.write("mine/slot/reconstruct/one.wgsl", OWN);
    scratch.write("t.ron", TRANSFER);
    scratch.write("g.ron", graph(SPHERE));
    scratch
}

#[test]
fn a_shader_is_linked_with_its_imports_and_their_names() {
    let scratch = scratch();
    let file = "shaders/slot/technique/dvr.wgsl";
    let run = scratch.run(&["link", file]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    for line in [
        "// from shaders/slot/technique/dvr.wgsl:10",
        "// from shaders/lib/ray.wgsl:1",
        "// from shaders/slot/light/unlit.wgsl:1",
    ] {
        assert!(
            run.stdout.lines().any(|l| l == line),
            "{line}: {}",
            run.stdout
        );
    }
    let plain = scratch.run(&["link", file, "--plain", "--slots", "light=phong"]);
    assert_eq!(plain.code, Some(0));
    assert!(!plain.stdout.contains("// from ") && !plain.stdout.contains("#import"));
    assert!(plain.stdout.contains("shininess"), "{}", plain.stdout);
    // What was printed is plain WGSL.
    assert!(naga::front::wgsl::parse_str(&plain.stdout).is_ok());
}

#[test]
fn a_choice_is_linked_in_a_nodes_shader() {
    let scratch = scratch();
    let own = "mine/slot/reconstruct/one.wgsl";
    let alone = scratch.run(&["link", own, "--shaders", "shaders"]);
    assert!(alone.code == Some(0) && !alone.stdout.contains("raycast_vertex"));
    let run = scratch.run(&["link", own, "--node", "raycast", "--shaders", "shaders"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(
        run.stdout
            .contains("// from mine/slot/reconstruct/one.wgsl:1")
    );
    assert!(run.stdout.contains("fn raycast_vertex"));
    // The slot `gradient` is imported by another choice of another slot only.
    let stored = "shaders/slot/gradient/stored.wgsl";
    let run = scratch.run(&["link", stored, "--node", "raycast"]);
    assert!(
        run.code == Some(0) && run.stdout.contains("fn gradient_at"),
        "{run:?}"
    );
}

#[test]
fn a_graphs_node_has_the_graphs_choices() {
    let scratch = scratch();
    let lit = graph(SPHERE).replace(
        "\"rays\": \"box\" }",
        "\"rays\": \"box\" }, slots: { \"light\": \"phong\" }",
    );
    scratch.write("lit.ron", lit);
    for (args, shines) in [
        (&["link", "g.ron", "--node", "image"][..], false),
        (&["link", "lit.ron", "--node", "image"], true),
        (
            &["link", "g.ron", "--node", "image", "--slots", "light=phong"],
            true,
        ),
        (
            &[
                "link",
                "lit.ron",
                "--node",
                "image",
                "--slots",
                "light=unlit",
            ],
            false,
        ),
    ] {
        let run = scratch.run(args);
        assert_eq!(
            (run.code, run.stdout.contains("shininess")),
            (Some(0), shines),
            "{args:?}: {run:?}"
        );
    }
    // A node that a shader called for has a text as well.
    let run = scratch.run(&["link", "lit.ron", "--node", "image.gradient"]);
    assert!(
        run.code == Some(0) && run.stdout.contains("node/gradient.wgsl"),
        "{run:?}"
    );
}

#[test]
fn what_cannot_be_linked_is_told() {
    let scratch = scratch();
    let dvr = "shaders/slot/technique/dvr.wgsl";
    for (args, code, words) in [
        (&["link", "no.wgsl"][..], "missing-shader", "no.wgsl"),
        (
            &["link", dvr, "--slots", "lihgt=phong"],
            "unknown-slot",
            "did you mean `light`?",
        ),
        (
            &["link", dvr, "--slots", "light=phnog"],
            "unknown-choice",
            "did you mean `phong`?",
        ),
        (
            &["link", dvr, "--node", "raycats"],
            "unknown-kind",
            "did you mean `raycast`?",
        ),
        (
            &["link", dvr, "--node", "background"],
            "not-imported",
            "`raycast`",
        ),
        (
            &["link", dvr, "--node", "proxy_box"],
            "not-imported",
            "`raycast`",
        ),
        (
            &["link", "shaders/lib/ray.wgsl", "--node", "proxy_box"],
            "no-shader",
            "--node",
        ),
        (
            &["link", "shaders/lib/ray.wgsl", "--node", "background"],
            "not-imported",
            "--node",
        ),
        (&["link", "g.ron"], "node-unset", "`image`"),
        (
            &["link", "g.ron", "--node", "imgae"],
            "unknown-node",
            "did you mean `image`?",
        ),
        (&["link", "g.ron", "--node", "box"], "no-shader", "`image`"),
        (
            &["link", "g.ron", "--node", "image", "--slots", "lihgt=phong"],
            "unknown-slot",
            "did you mean `light`?",
        ),
        (&["link", "no.ron", "--node", "image"], "io", "no.ron"),
    ] {
        let run = scratch.run(args);
        assert_eq!(
            (run.code, run.stdout.as_str()),
            (Some(1), ""),
            "{args:?}: {run:?}"
        );
        assert!(
            run.stderr.contains(&format!("error[{code}]")) && run.stderr.contains(words),
            "{args:?}: {}",
            run.stderr
        );
    }
    let run = scratch.run(&["link", dvr, "--slots", "light"]);
    assert_eq!(run.code, Some(2), "{run:?}");
}

#[test]
fn a_text_with_errors_is_printed_and_its_errors_are_told() {
    let scratch = scratch();
    scratch.write("mine/slot/reconstruct/one.wgsl", OWN.replace("1.0", "nope"));
    let run = scratch.run(&["link", "mine/slot/reconstruct/one.wgsl"]);
    assert_eq!(run.code, Some(1));
    assert!(run.stdout.contains("return nope;"), "{run:?}");
    assert!(
        run.stderr.contains("mine/slot/reconstruct/one.wgsl:4:12"),
        "{}",
        run.stderr
    );
}
