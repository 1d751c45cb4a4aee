//! From text to a description: nothing that anybody writes may panic.

use std::path::Path;

use proptest::prelude::*;
use volgraph_graph::{Budget, Pose, Projection, read};
use volgraph_shader::ParamValue;

use crate::{codes, graph_text};

fn graph(text: &str) -> Result<volgraph_graph::GraphDesc, volgraph_report::Findings> {
    read::graph(Path::new("g.ron"), text)
}

const WHOLE: &str = r#"(
    sources: { "v": volume(path: "a.nrrd", dims: (1, 2, 3)), "t": transfer(path: r"b.ron") },
    camera: look_at(eye: (1, 2, 3), target: (0, 0, 0.5), up: (0, 1, 0), projection: orthographic, height: 2),
    nodes: {
        "box": (kind: "proxy_box", in: { "volume": "v" }),
        "image": (kind: "raycast", in: { "rays": "box.rays" }, slots: { "light": "phong" },
                  params: { "step": 0.5, "n": 3, "on": true, "axis": [1, 0, 0], "word": "x" }),
    },
    outputs: { "color": "image.color" },
)"#;

#[test]
fn every_part_of_a_graph_is_read() {
    let desc = graph(WHOLE).unwrap();
    assert_eq!(
        desc.sources["v"].params["dims"].value,
        ParamValue::Vector(vec![1.0, 2.0, 3.0])
    );
    let params = &desc.nodes["image"].params;
    let values: Vec<_> = params.values().map(|param| param.value.clone()).collect();
    let expected = [
        ParamValue::Float(0.5),
        ParamValue::Int(3),
        ParamValue::Bool(true),
        ParamValue::Vector(vec![1.0, 0.0, 0.0]),
        ParamValue::Text("x".to_owned()),
    ];
    assert_eq!(values, expected);
    assert_eq!(
        (params["step"].name_place.line, params["step"].place.column),
        (7, 37)
    );
    let camera = desc.camera.unwrap();
    assert!(matches!(camera.pose, Pose::LookAt { .. }));
    assert_eq!(
        camera.projection,
        Projection::Orthographic { height: Some(2.0) }
    );
}

#[test]
fn a_budget_has_one_side() {
    let with = |quality: &str| {
        graph(&WHOLE.replacen("nodes:", &format!("quality: {quality},\n nodes:"), 1))
    };
    let budget = |quality: &str| with(quality).unwrap().quality.unwrap().budget;
    assert_eq!(budget("budget(rmse: 0.002)"), Budget::Rmse(0.002));
    assert_eq!(budget("budget(time_ms: 40)"), Budget::TimeMs(40.0));
    assert_eq!(graph(WHOLE).unwrap().quality, None);
    for (quality, code) in [
        ("budget()", "missing-field"),
        ("budget(rmse: 0.1, time_ms: 3)", "exclusive-fields"),
        ("budget(rmse: 0)", "bad-budget"),
        ("budget(rmse: -0.1)", "bad-budget"),
        ("budget(time_ms: 1e99)", "bad-budget"),
        ("budget(rms: 0.1)", "unknown-field"),
        ("best", "unknown-quality"),
    ] {
        assert_eq!(codes(&with(quality).unwrap_err()), [(code, 4)], "{quality}");
    }
}

#[test]
fn everything_wrong_is_told_at_once() {
    let text = r#"(
        camera: orbit(azimut: 1, fov_y: 200, distance: -1),
        nodes: {
            "a": (kind: "x", inn: {}),
            "b": (in: { "y": 3 }),
            "": (kind: "x"),
            "c.d": (kind: "x"),
        },
        output: { "color": "a" },
    )"#;
    let found = codes(&graph(text).unwrap_err());
    let expected = [
        ("unknown-field", 2),
        ("camera", 2),
        ("camera", 2),
        ("unknown-field", 4),
        ("missing-field", 5),
        ("wrong-type", 5),
        ("bad-name", 6),
        ("bad-name", 7),
        ("unknown-field", 9),
    ];
    assert_eq!(found, expected);
}

#[test]
fn names_given_twice_and_no_outputs_are_told() {
    let code = |text: &str| graph(text).unwrap_err().sorted()[0].code;
    assert_eq!(
        code(r#"(nodes: { "a": (kind: "x"), "a": (kind: "y") }, outputs: { "color": "a" })"#),
        "duplicate"
    );
    assert_eq!(
        code(r#"(nodes: { "a": (kind: "x") }, outputs: { "c": "a", "c": "b" })"#),
        "duplicate"
    );
    assert_eq!(
        code(r#"(sources: { "a": v() }, nodes: { "a": (kind: "x") }, outputs: { "c": "a" })"#),
        "duplicate"
    );
    assert_eq!(code(r#"(nodes: { "a": (kind: "x") })"#), "no-output");
    assert_eq!(code("(nodes: {"), "ron-syntax");
    assert_eq!(
        code(r#"(camera: fly(), outputs: { "c": "a" })"#),
        "unknown-camera"
    );
}

#[test]
fn what_is_too_large_is_refused_before_it_costs_time() {
    let long = format!("({})", " ".repeat(300 << 10));
    assert_eq!(codes(&graph(&long).unwrap_err()), [("too-large", 0)]);
    let many: String = (0..1025)
        .map(|i| format!("\"n{i}\": (kind: \"x\"),\n"))
        .collect();
    assert_eq!(
        codes(&graph(&graph_text(&many, "\"c\": \"n0\"")).unwrap_err()),
        [("too-large", 3)]
    );
}

#[test]
fn values_on_the_command_line_are_read_by_their_form() {
    let value = |text: &str| read::param_text(Path::new("--set"), text);
    assert_eq!(value("1e3").unwrap(), ParamValue::Float(1000.0));
    assert_eq!(value("-2").unwrap(), ParamValue::Int(-2));
    assert!(value("fragment").is_err() && value("").is_err() && value("1e999").is_err());
    assert!(read::camera_text(Path::new("--camera"), "orbit(azimuth: 3)").is_ok());
    assert!(read::camera_text(Path::new("--camera"), "orbit(azimuth: 3").is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn arbitrary_text_never_panics(text in ".{0,200}") {
        let _ = graph(&text);
        let _ = read::camera_text(Path::new("c"), &text);
        let _ = read::param_text(Path::new("p"), &text);
    }

    #[test]
    fn words_of_a_graph_in_any_order_never_panic(words in prop::collection::vec(prop::sample::select(vec![
        "(", ")", "{", "}", "[", "]", ":", ",", "\"a\"", "\"a.b\"", "sources", "nodes", "outputs", "camera", "kind",
        "in", "slots", "params", "orbit", "look_at", "eye", "fov_y", "1", "-0.5", "1e999", "true", "r\"x\"", "'", "\\",
        "\n", "//", "/*", "*/", "ä", "Some", "()",
    ]), 0..60)) {
        let _ = graph(&words.concat());
        let _ = graph(&words.join(" "));
    }

    #[test]
    fn a_damaged_graph_never_panics(at in 0..WHOLE.len(), len in 0..40_usize, with in ".{0,3}") {
        let end = (at + len).min(WHOLE.len());
        let text = format!("{}{with}{}", &WHOLE[..at], &WHOLE[end..]);
        if let Err(findings) = graph(&text) {
            // Every place is in the text.
            let lines = u32::try_from(text.lines().count().max(1)).unwrap();
            for finding in findings.sorted() {
                let line = finding.place.as_ref().map_or(0, |place| place.line);
                prop_assert!(line <= lines + 1, "{finding}");
            }
        }
    }
}
