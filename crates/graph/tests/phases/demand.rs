//! What shaders call for.

use volgraph_graph::Origin;
use volgraph_shader::ParamValue;

use crate::{demand, graph_text, id, names, only};

fn paint(light: &str) -> String {
    format!(
        "\"p\": (kind: \"paint\", in: {{ \"volume\": \"f\" }}, slots: {{ \"light\": \"{light}\" }}),"
    )
}

#[test]
fn a_used_binding_calls_for_its_node_and_that_for_its_own() {
    let graph = demand(&graph_text(&paint("tabled"), "\"color\": \"p\"")).unwrap();
    assert_eq!(names(&graph), ["f", "p", "p.table", "p.table.upload"]);
    let table = &graph.nodes[id(&graph, "p.table")];
    assert_eq!(
        graph.nodes[id(&graph, "p")].inputs["table"].node,
        id(&graph, "p.table")
    );
    assert_eq!(
        table.params["gain"],
        ParamValue::Float(2.0),
        "it gets its caller's parameter"
    );
    assert_eq!(
        table.origin,
        Origin::Demanded {
            by: id(&graph, "p"),
            binding: "table".to_owned()
        }
    );
}

#[test]
fn nothing_is_called_for_by_what_no_entry_point_uses() {
    let graph = demand(&graph_text(&paint("flat"), "\"color\": \"p\"")).unwrap();
    assert_eq!(names(&graph), ["f", "p"]);
}

#[test]
fn a_connected_port_that_nobody_reads_is_let_go_and_one_that_is_read_is_kept() {
    for (light, is_read) in [("flat", false), ("over", true)] {
        let nodes = format!(
            "\"q\": (kind: \"paint\"), \"p\": (kind: \"paint\", in: {{ \"behind\": \"q\" }}, slots: {{ \"light\": \"{light}\" }}),"
        );
        let graph = demand(&graph_text(&nodes, "\"color\": \"p\"")).unwrap();
        assert_eq!(
            graph.nodes[id(&graph, "p")].inputs.contains_key("behind"),
            is_read,
            "{light}"
        );
    }
}

#[test]
fn the_files_own_writer_goes_before_a_demand() {
    let nodes = "\"t\": (kind: \"table\", in: { \"volume\": \"f\" }),
        \"p\": (kind: \"paint\", in: { \"table\": \"t\" }, slots: { \"light\": \"tabled\" }),";
    let graph = demand(&graph_text(nodes, "\"color\": \"p\"")).unwrap();
    assert_eq!(names(&graph), ["f", "t", "p", "t.upload"]);
}

#[test]
fn equal_demands_share_one_node_and_unequal_ones_do_not() {
    let two = |amount: &str| {
        let nodes = format!(
            "{} \"q\": (kind: \"paint\", in: {{ \"volume\": \"f\", \"behind\": \"p\" }}, \
             slots: {{ \"light\": \"tabled\" }}, params: {{ \"amount\": {amount} }}),",
            paint("tabled")
        );
        let graph = demand(&graph_text(&nodes, "\"a\": \"p\", \"b\": \"q\"")).unwrap();
        names(&graph)
            .iter()
            .filter(|name| name.ends_with(".table"))
            .count()
    };
    assert_eq!(two("2.0"), 1);
    assert_eq!(two("3.0"), 2);
}

/// `outer` calls for the table only after the table's own shader has given that parameters and an input.
#[test]
fn a_demand_finds_a_node_that_is_linked_already() {
    let graph = demand(&graph_text(&paint("both"), "\"color\": \"p\"")).unwrap();
    assert_eq!(
        names(&graph),
        ["f", "p", "p.table", "p.outer", "p.table.upload"]
    );
    let outer = &graph.nodes[id(&graph, "p.outer")];
    assert_eq!(outer.inputs["table"].node, id(&graph, "p.table"));
}

#[test]
fn what_is_called_for_alike_gets_all_that_it_has_by_that_name_and_no_more() {
    let echoed = |name: &str, params: &str| {
        format!(
            "\"{name}\": (kind: \"paint\", in: {{ \"volume\": \"f\" }}, slots: {{ \"light\": \"echoed\" }}, \
             params: {{ {params} }}),"
        )
    };
    let one = echoed("p", "\"tint\": 0.25, \"gloss\": 0.5, \"amount\": 3.0");
    let graph = demand(&graph_text(&one, "\"color\": \"p\"")).unwrap();
    assert_eq!(names(&graph), ["f", "p", "p.echo"]);
    let echo = &graph.nodes[id(&graph, "p.echo")];
    let params: Vec<_> = echo
        .params
        .iter()
        .map(|(name, value)| (name.as_str(), value))
        .collect();
    let (amount, tint) = (ParamValue::Float(3.0), ParamValue::Float(0.25));
    assert_eq!(params, [("amount", &amount), ("tint", &tint)]);
    assert_eq!(echo.given.len(), 2, "what it does not declare is not given");
    assert_eq!(echo.slots["light"].choice, "echoed");
    assert_eq!(echo.inputs["volume"].node, id(&graph, "f"));
    assert!(
        !echo.inputs.contains_key("behind"),
        "what is open stays open"
    );

    // Two that differ in what it does not take share one.
    for (other, count) in [
        ("\"tint\": 0.25, \"gloss\": 0.7, \"amount\": 3.0", 1),
        ("\"tint\": 0.3, \"gloss\": 0.5, \"amount\": 3.0", 2),
    ] {
        let two = format!("{one} {}", echoed("q", other));
        let graph = demand(&graph_text(&two, "\"a\": \"p\", \"b\": \"q\"")).unwrap();
        let of = |name: &str| graph.nodes[id(&graph, name)].inputs["echo"].node;
        let distinct = if of("p") == of("q") { 1 } else { 2 };
        assert_eq!(distinct, count, "{other}");
        let live = graph.live();
        let live = live
            .iter()
            .filter(|node| graph.nodes[**node].name.contains("echo"));
        assert_eq!(live.count(), count, "what stands for nothing is not live");
    }
}

#[test]
fn a_demand_without_its_input_names_binding_and_port() {
    let nodes = "\"p\": (kind: \"paint\", slots: { \"light\": \"tabled\" }),";
    let finding = only(demand(&graph_text(nodes, "\"color\": \"p\"")));
    assert_eq!(finding.code, "missing-input");
    assert_eq!(finding.place.unwrap().line, 4);
    assert!(
        finding.message.contains("`volume`") && finding.message.contains("`table`"),
        "{}",
        finding.message
    );
    let (used, _) = &finding.related[0];
    assert_eq!(
        (used.file.to_str(), used.line),
        (Some("/s/slot/light/tabled.wgsl"), 1)
    );
}

#[test]
fn what_cannot_be_called_for_is_told() {
    assert_eq!(
        only(demand(&graph_text(
            &paint("unregistered"),
            "\"color\": \"p\""
        )))
        .code,
        "unknown-kind"
    );
    let headless = "\"p\": (kind: \"headless\"),";
    assert_eq!(
        only(demand(&graph_text(headless, "\"color\": \"p\""))).code,
        "missing-entry"
    );
    let finding = only(demand(&graph_text(&paint("flt"), "\"color\": \"p\"")));
    assert_eq!(
        (finding.code, finding.place.unwrap().line),
        ("unknown-choice", 4),
        "where the graph chooses"
    );
}

#[test]
fn parameters_and_inputs_are_taken_over_from_the_writer_unless_the_node_gives_its_own() {
    let nodes = |own: &str, light: &str| {
        format!(
            "\"q\": (kind: \"paint\", in: {{ \"volume\": \"f\" }}, slots: {{ \"light\": \"over_with_params\" }}, \
             params: {{ \"one\": 5.0, \"two\": 6.0, \"amount\": 3.0 }}), \
             \"p\": (kind: \"mirror\", in: {{ \"behind\": \"q\" }}, slots: {{ \"light\": \"{light}\" }}, params: {{ {own} }}),"
        )
    };
    let mirror = |own: &str, light: &str| {
        let graph = demand(&graph_text(&nodes(own, light), "\"color\": \"p\"")).unwrap();
        let id = id(&graph, "p");
        graph.nodes[id].clone()
    };
    let node = mirror("\"one\": 7.0", "over_with_params");
    assert_eq!(node.params["one"], ParamValue::Float(7.0), "its own");
    assert_eq!(node.params["two"], ParamValue::Float(6.0), "the writer's");
    assert!(node.inputs.contains_key("volume"));
    assert_ne!(
        node.params.get("amount"),
        Some(&ParamValue::Float(3.0)),
        "only what the slot's file declares"
    );
    // What the writer may not have either is the default; the writer's check reports it.
    let text = nodes("", "over_with_params").replace("6.0", "60.0");
    let graph = demand(&graph_text(&text, "\"color\": \"p\"")).unwrap();
    let params = &graph.nodes[id(&graph, "p")].params;
    assert_eq!(params["two"], ParamValue::Float(2.0));
    // A choice without parameters takes over none.
    let node = mirror("", "over");
    assert!(!node.params.contains_key("two"));
}
