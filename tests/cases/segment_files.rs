//! What is wrong with labels and their segments is told at its place; a graph without them has nothing of them.

use volgraph_tests::{Stage, adapters};

use crate::segments::{BLUE_IS_1, CAMERAS, graph, stage, transfer};

#[test]
fn what_is_no_label_and_no_segment_is_told_at_its_place() {
    let told = |stage: &Stage| -> Vec<(String, u32)> {
        let backend = &adapters()[0];
        let findings = stage.open("graph.ron", &[], backend, [8, 8]).err().unwrap();
        findings
            .sorted()
            .into_iter()
            .map(|it| {
                (
                    it.code.to_owned(),
                    it.place.as_ref().map_or(0, |place| place.line),
                )
            })
            .collect()
    };
    let has = |told: &[(String, u32)], code: &str, line: u32| {
        assert!(
            told.contains(&(code.to_owned(), line)),
            "{code}:{line} in {told:?}"
        );
    };
    let graph = graph("(1, 1, 1)", CAMERAS[0], "", "");
    let found = told(&stage(|x, _, _| x * 50, BLUE_IS_1).with("graph.ron", &graph));
    assert_eq!(found[0].0, "bad-labels");
    let bad = "(\n segments: [\n  (label: 256),\n  (label: 1, trnsfer: \"a.ron\"),\n  (label: 1),\n  (name: \"x\"),\n  (label: 2, transfer: \"none.ron\"),\n ],\n)";
    let found = told(&stage(|_, _, _| 1, bad).with("graph.ron", &graph));
    for (code, line) in [
        ("out-of-range", 3),
        ("unknown-field", 4),
        ("duplicate", 5),
        ("missing-field", 6),
        ("io", 0),
    ] {
        has(&found, code, line);
    }
    let bad = "(\n segments: [\n  (label: 1, params: {\n \"stepp\": 1 }),\n  (label: 2, params: {\n \"step\": 1000 }),\n  (label: 3, params: {\n \"table_size\": 2048 })])";
    let found = told(&stage(|_, _, _| 1, bad).with("graph.ron", &graph));
    for (code, line) in [("unknown-param", 4), ("bad-param", 6), ("unknown-param", 8)] {
        has(&found, code, line);
    }
    let without = graph.replace(r#""transfer": "colors", "#, "");
    let found = told(&stage(|_, _, _| 1, "(segments: [(label: 1)])").with("graph.ron", &without));
    assert_eq!(found[0].0, "missing-input");
    let many: String = (1..9)
        .map(|i| format!("(label: {i}, transfer: \"m{i}.ron\"), "))
        .collect();
    let mut crowd = stage(|_, _, _| 1, &format!("(segments: [{many}])")).with(
        "graph.ron",
        graph
            .replace(
                r#""labels": "volume", "#,
                r#""labels": "volume", "classify": "preintegrated_2d""#,
            )
            .replace(
                r#""early_termination": 0.0, "#,
                r#""preintegration_size": 4096"#,
            ),
    );
    for i in 1..9 {
        crowd = crowd.with(&format!("m{i}.ron"), transfer("(1, 1, 1)", f64::from(i)));
    }
    assert_eq!(told(&crowd)[0].0, "over-limit");
}

#[test]
fn a_graph_without_labels_has_none_of_this() {
    let stage = stage(|_, _, _| 1, BLUE_IS_1).with(
        "graph.ron",
        graph("(1, 1, 1)", CAMERAS[0], "", "").replace(r#""labels": "volume", "#, ""),
    );
    let session = stage
        .open("graph.ron", &[], &adapters()[0], [8, 8])
        .unwrap();
    let nodes = session.plan().nodes();
    assert!(nodes.iter().all(|node| node.kind != "label_texture"));
    let image = nodes.iter().find(|node| node.name == "image").unwrap();
    for bindings in image.entries.values() {
        for binding in bindings {
            let of_labels = [
                "params_table",
                "transfers",
                "transfer_tables",
                "segmentation",
                "label_texture",
            ];
            assert!(!of_labels.contains(&binding.name.as_str()), "{binding:?}");
        }
    }
}
