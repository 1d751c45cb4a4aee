//! What the outputs need, and in which order.

use volgraph_graph::cull::cull;
use volgraph_graph::order::order;
use volgraph_graph::{Graph, Limits, Origin};

use crate::{demand, graph_text, id, names, plan};

#[test]
fn what_no_output_needs_is_dropped_and_edges_still_lead_to_their_writers() {
    let nodes =
        "\"dead\": (kind: \"paint\", in: { \"volume\": \"f\" }, slots: { \"light\": \"tabled\" }),
        \"p\": (kind: \"paint\"), \"h\": (kind: \"half\", in: { \"image\": \"p\" }),";
    let (kept, dropped) = cull(&demand(&graph_text(nodes, "\"color\": \"h\"")).unwrap());
    assert_eq!(names(&kept), ["p", "h"]);
    assert_eq!(dropped, ["f", "dead", "dead.table", "dead.table.upload"]);
    assert_eq!(
        kept.nodes[id(&kept, "h")].inputs["image"].node,
        id(&kept, "p")
    );
    assert_eq!(kept.outputs["color"].node, id(&kept, "h"));
}

#[test]
fn nothing_is_dropped_of_what_an_output_needs() {
    let nodes =
        "\"p\": (kind: \"paint\", in: { \"volume\": \"f\" }, slots: { \"light\": \"both\" }),";
    let graph = demand(&graph_text(nodes, "\"color\": \"p\"")).unwrap();
    let (kept, dropped) = cull(&graph);
    assert!(dropped.is_empty(), "{dropped:?}");
    assert_eq!(names(&kept), names(&graph));
}

#[test]
fn a_shared_node_whose_first_caller_is_dropped_names_the_caller_that_is_left() {
    let paint = "(kind: \"paint\", in: { \"volume\": \"f\" }, slots: { \"light\": \"tabled\" })";
    let nodes = format!("\"dead\": {paint}, \"p\": {paint},");
    let (kept, dropped) = cull(&demand(&graph_text(&nodes, "\"color\": \"p\"")).unwrap());
    assert_eq!(dropped, ["dead"]);
    let table = &kept.nodes[id(&kept, "dead.table")];
    assert_eq!(
        table.origin,
        Origin::Demanded {
            by: id(&kept, "p"),
            binding: "table".to_owned()
        }
    );
}

fn ordered(graph: &Graph) -> Vec<&str> {
    order(graph)
        .into_iter()
        .map(|id| graph.nodes[id].name.as_str())
        .collect()
}

#[test]
fn writers_come_before_readers_and_the_file_decides_ties() {
    let half = |name: &str, from: &str| {
        format!("\"{name}\": (kind: \"half\", in: {{ \"image\": \"{from}\" }}),")
    };
    let paint = "\"p\": (kind: \"paint\"),";
    let forward = format!("{paint}{}{}", half("a", "p"), half("b", "p"));
    let backward = format!("{}{}{paint}", half("b", "p"), half("a", "p"));
    let outputs = "\"x\": \"a\", \"y\": \"b\"";
    assert_eq!(
        ordered(&demand(&graph_text(&forward, outputs)).unwrap()),
        ["f", "p", "a", "b"]
    );
    assert_eq!(
        ordered(&demand(&graph_text(&backward, outputs)).unwrap()),
        ["f", "p", "b", "a"]
    );
}

#[test]
fn a_graph_has_one_plan() {
    let nodes = "\"q\": (kind: \"half\", in: { \"image\": \"p\" }),
        \"p\": (kind: \"paint\", in: { \"volume\": \"f\" }, slots: { \"light\": \"both\" }),";
    let text = graph_text(nodes, "\"color\": \"q\"");
    let one = plan(&text, [64, 64], &Limits::default()).unwrap();
    for _ in 0..4 {
        let other = plan(&text, [64, 64], &Limits::default()).unwrap();
        assert_eq!(other.to_text(), one.to_text());
        assert_eq!(other.to_json(), one.to_json());
        assert_eq!(other.to_dot(), one.to_dot());
    }
    let order: Vec<String> = one.nodes().into_iter().map(|node| node.name).collect();
    assert_eq!(order, ["p.table.upload", "p.table", "p.outer", "p", "q"]);
}
