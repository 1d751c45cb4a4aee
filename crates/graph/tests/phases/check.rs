//! Types, parameters, bindings, cycles.

use volgraph_graph::Limits;

use crate::{check, codes, graph_text, only, plan};

#[test]
fn a_right_graph_has_no_findings() {
    let nodes = "\"p\": (kind: \"paint\", in: { \"volume\": \"f\" }, slots: { \"light\": \"both\" }, params: { \"amount\": 1 }),
        \"h\": (kind: \"half\", in: { \"image\": \"p\" }),";
    check(&graph_text(nodes, "\"color\": \"h\"")).unwrap();
}

#[test]
fn types_and_parameters_are_checked_together() {
    let nodes = "\"p\": (kind: \"paint\", in: { \"behind\": \"f\" }, slots: { \"light\": \"over\" }),
\"q\": (kind: \"paint\", params: { \"amount\": 99 }),
\"r\": (kind: \"paint\", params: { \"amuont\": 1 }),
\"s\": (kind: \"paint\", params: { \"tint\": 2 }),
\"t\": (kind: \"paint\", in: { \"behind\": \"q\" }, params: { \"tint\": \"red\" }, slots: { \"light\": \"over\" }),";
    let findings = check(&graph_text(nodes, "\"color\": \"p\"")).unwrap_err();
    let expected = [
        ("type-mismatch", 4),
        ("bad-param", 5),
        ("unknown-param", 6),
        ("bad-param", 7),
        // Another choice for the slot has other parameters.
        ("unknown-param", 8),
    ];
    assert_eq!(codes(&findings), expected, "{findings}");
}

#[test]
fn a_used_binding_without_a_port_is_unknown() {
    let nodes = "\"p\": (kind: \"paint\", slots: { \"light\": \"strange\" }),";
    let finding = only(check(&graph_text(nodes, "\"color\": \"p\"")));
    assert_eq!(finding.code, "unknown-binding");
    assert_eq!(
        finding.place.unwrap().file.to_str(),
        Some("/s/slot/light/strange.wgsl")
    );
    assert!(finding.help.unwrap().contains("`table`"));
}

#[test]
fn a_binding_declared_as_another_texture_than_its_ports_is_told() {
    let nodes =
        "\"p\": (kind: \"paint\", in: { \"volume\": \"f\" }, slots: { \"light\": \"wrong_dim\" }),";
    let finding = only(check(&graph_text(nodes, "\"color\": \"p\"")));
    assert_eq!(
        (finding.code, finding.help.as_deref()),
        ("binding-type", Some("declare it as `texture_2d<f32>`"))
    );
}

#[test]
fn a_uniform_member_that_nobody_fills_is_told_before_a_frame() {
    let nodes = "\"p\": (kind: \"paint\", slots: { \"light\": \"unfilled\" }),";
    let text = graph_text(nodes, "\"color\": \"p\"");
    let finding = only(plan(&text, [8, 8], &Limits::default()));
    assert_eq!(finding.code, "uniform");
    assert!(finding.message.contains("zoom"), "{}", finding.message);
}

#[test]
fn cycles_are_named_along_the_data() {
    let over = "slots: { \"light\": \"over\" }";
    let nodes = format!(
        "\"a\": (kind: \"paint\", in: {{ \"behind\": \"c\" }}, {over}),
         \"b\": (kind: \"paint\", in: {{ \"behind\": \"a\" }}, {over}),
         \"c\": (kind: \"paint\", in: {{ \"behind\": \"b\" }}, {over}),
         \"d\": (kind: \"paint\", in: {{ \"behind\": \"b\" }}, {over}),"
    );
    let finding = only(check(&graph_text(&nodes, "\"color\": \"d\"")));
    assert_eq!(finding.code, "cycle");
    assert!(
        finding.message.ends_with("b → c → a → b") || finding.message.ends_with("a → b → c → a"),
        "{}",
        finding.message
    );
    assert_eq!(finding.related.len(), 2, "the other two nodes");
    let itself = format!("\"a\": (kind: \"paint\", in: {{ \"behind\": \"a\" }}, {over}),");
    assert!(
        only(check(&graph_text(&itself, "\"color\": \"a\"")))
            .message
            .ends_with("a → a")
    );
}

#[test]
fn a_diamond_is_no_cycle_and_a_long_chain_is_no_trouble() {
    let nodes = "\"a\": (kind: \"paint\"), \"b\": (kind: \"half\", in: { \"image\": \"a\" }),
        \"p\": (kind: \"paint\", in: { \"behind\": \"b\", \"outer\": \"a\" }, slots: { \"light\": \"over\" }),";
    check(&graph_text(nodes, "\"color\": \"p\"")).unwrap();
    let chain: String = (1..1000)
        .map(|i| {
            format!(
                "\"n{i}\": (kind: \"half\", in: {{ \"image\": \"n{}\" }}),\n",
                i - 1
            )
        })
        .collect();
    let nodes = format!("\"n0\": (kind: \"paint\"),\n{chain}");
    check(&graph_text(&nodes, "\"color\": \"n999\"")).unwrap();
}

#[test]
fn a_source_is_no_output() {
    let finding = only(check(&graph_text(
        "\"p\": (kind: \"paint\"),",
        "\"color\": \"f\"",
    )));
    assert_eq!(
        (finding.code, finding.place.unwrap().line),
        ("type-mismatch", 6)
    );
}
