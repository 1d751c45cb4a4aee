//! Graphs, command lines and transfer functions that do not fit.

use super::{Bad, PLAN, bad};
use crate::{SPHERE, graph};

/// The graph with one part replaced.
fn replaced(
    what: &'static str,
    find: &str,
    with: &str,
    code: &'static str,
    place: &'static str,
) -> Bad {
    let text = graph(SPHERE);
    assert!(text.contains(find), "{what}");
    bad(
        what,
        vec![("g.ron", text.replacen(find, with, 1).into_bytes())],
        &PLAN,
        code,
        place,
    )
}

/// The right graph, and a transfer function that is not.
fn transfer(what: &'static str, text: &str, code: &'static str, place: &'static str) -> Bad {
    bad(
        what,
        vec![
            ("g.ron", graph(SPHERE).into_bytes()),
            ("t.ron", text.into()),
        ],
        &PLAN,
        code,
        place,
    )
}

pub fn graphs() -> Vec<Bad> {
    let cycle = "\"a\": (kind: \"raycast\", in: { \"volume\": \"v\", \"rays\": \"box\", \"transfer\": \"t\", \"behind\": \"image\" }),
        \"image\": (kind: \"raycast\", in: { \"behind\": \"a\", ";
    let huge = ["plan", "g.ron", "--size", "100000x100000"];
    let right = || vec![("g.ron", graph(SPHERE).into_bytes())];
    vec![
        replaced(
            "a cycle",
            "\"image\": (kind: \"raycast\", in: { ",
            cycle,
            "cycle",
            "g.ron:8",
        ),
        replaced(
            "unknown kind",
            "\"raycast\"",
            "\"raycats\"",
            "unknown-kind",
            "g.ron:8",
        ),
        replaced(
            "unknown port",
            "\"rays\": \"box\"",
            "\"rays\": \"box\", \"front\": \"box\"",
            "unknown-port",
            "g.ron:8",
        ),
        replaced(
            "unknown output port",
            "image.color",
            "image.colour",
            "unknown-port",
            "g.ron:10",
        ),
        replaced(
            "unknown field",
            "outputs",
            "ouputs: {}, outputs",
            "unknown-field",
            "g.ron:10",
        ),
        replaced(
            "unknown parameter",
            "\"box\" })",
            "\"box\" }, params: { \"stpe\": 1 })",
            "unknown-param",
            "g.ron:8",
        ),
        replaced(
            "a parameter out of range",
            "\"box\" })",
            "\"box\" }, params: { \"step\": -1 })",
            "bad-param",
            "g.ron:8",
        ),
        replaced(
            "unknown slot",
            "\"box\" })",
            "\"box\" }, slots: { \"lights\": \"phong\" })",
            "unknown-slot",
            "g.ron:8",
        ),
        replaced(
            "unknown choice",
            "\"box\" })",
            "\"box\" }, slots: { \"light\": \"phnog\" })",
            "unknown-choice",
            "g.ron:8",
        ),
        replaced(
            "unknown source kind",
            "analytic",
            "analytical",
            "unknown-source-kind",
            "g.ron:3",
        ),
        replaced(
            "unknown analytic field",
            "sphere",
            "cube",
            "volume-field",
            "g.ron:3",
        ),
        replaced(
            "unknown camera",
            "    nodes",
            "    camera: fly(fov_y: 30),\n    nodes",
            "unknown-camera",
            "g.ron:6",
        ),
        replaced(
            "missing input",
            ", \"rays\": \"box\"",
            "",
            "missing-input",
            "g.ron:8",
        ),
        replaced(
            "no transfer function",
            "\"transfer\": \"t\", ",
            "",
            "missing-input",
            "g.ron:8",
        ),
        replaced(
            "two outputs of one name",
            "\"image.color\"",
            "\"image.color\", \"color\": \"image.depth\"",
            "duplicate",
            "g.ron:10",
        ),
        replaced(
            "two nodes of one name",
            "\"box\": (",
            "\"image\": (kind: \"proxy_box\"),\n\"box\": (",
            "duplicate",
            "g.ron:9",
        ),
        replaced(
            "an edge of another type",
            "\"rays\": \"box\"",
            "\"rays\": \"v\"",
            "type-mismatch",
            "g.ron:8",
        ),
        replaced(
            "a value of another type",
            "(8, 8, 8)",
            "\"eight\"",
            "bad-param",
            "g.ron:3",
        ),
        replaced(
            "a volume of zero size",
            "(8, 8, 8)",
            "(8, 0, 8)",
            "bad-param",
            "g.ron:3",
        ),
        replaced(
            "a volume of 10^12 voxels",
            "(8, 8, 8)",
            "(10000, 10000, 10000)",
            "volume-too-large",
            "g.ron:3",
        ),
        replaced(
            "no outputs",
            "outputs: { \"color\": \"image.color\" },",
            "",
            "no-output",
            "g.ron:1",
        ),
        replaced(
            "a source as an output",
            "image.color",
            "v",
            "type-mismatch",
            "g.ron:10",
        ),
        replaced("no RON", "nodes: {", "nodes: <", "ron-syntax", "g.ron:6"),
        bad(
            "no text",
            vec![("g.ron", vec![0xff, 0xfe, 0, 1])],
            &PLAN,
            "io",
            "g.ron",
        ),
        bad("no file", vec![], &["plan", "no.ron"], "io", "no.ron"),
        bad(
            "a folder",
            vec![("f/x", vec![])],
            &["plan", "f"],
            "not-a-graph",
            "f",
        ),
        bad(
            "unknown --set target",
            right(),
            &["plan", "g.ron", "--set", "imgae.step=1"],
            "unknown-node",
            "--set imgae.step=1",
        ),
        bad(
            "unknown --set parameter",
            right(),
            &["plan", "g.ron", "--set", "image.stpe=1"],
            "unknown-param",
            "--set image.stpe=1",
        ),
        bad(
            "bad --set value",
            right(),
            &["plan", "g.ron", "--set", "image.step=fast"],
            "bad-param",
            "--set image.step=fast",
        ),
        bad(
            "unknown --volume source",
            right(),
            &["plan", "g.ron", "--volume", "w=x.nrrd"],
            "unknown-node",
            "--volume w=x.nrrd",
        ),
        bad(
            "a picture over the limits",
            right(),
            &huge,
            "over-limit",
            "g.ron:8",
        ),
        bad(
            "no picture format",
            right(),
            &["render", "g.ron", "-o", "out.jpg"],
            "picture-extension",
            "out.jpg",
        ),
        bad(
            "no transfer file",
            vec![(
                "g.ron",
                graph(SPHERE).replace("t.ron", "no.ron").into_bytes(),
            )],
            &PLAN,
            "io",
            "no.ron",
        ),
        transfer(
            "opacity over 1",
            "(\n  color: (1, 1, 1),\n  opacity: [(0, 0), (1, 2)],\n)",
            "out-of-range",
            "t.ron:3",
        ),
        transfer(
            "unknown colour map",
            "(color: map(name: \"virids\"), opacity: [(0, 1)])",
            "unknown-color-map",
            "t.ron:1",
        ),
    ]
}
