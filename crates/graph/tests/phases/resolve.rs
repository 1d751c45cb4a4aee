//! Names, ports, slots and their defaults.

use volgraph_shader::ParamValue;

use crate::{codes, graph_text, id, only, resolve};

#[test]
fn names_become_nodes_and_what_is_not_said_has_its_default() {
    let nodes = "\"p\": (kind: \"paint\", in: { \"volume\": \"f\", \"behind\": \"q.color\" }, params: { \"amount\": 3 }),
                 \"q\": (kind: \"paint\", slots: { \"light\": \"tabled\" }),";
    let graph = resolve(&graph_text(nodes, "\"color\": \"p\"")).unwrap();
    let (p, q) = (&graph.nodes[id(&graph, "p")], &graph.nodes[id(&graph, "q")]);
    assert_eq!(
        graph.outputs["color"].port, "color",
        "a node's first port is its default one"
    );
    assert_eq!(
        p.inputs["behind"].node,
        id(&graph, "q"),
        "a writer may stand after its reader"
    );
    assert_eq!(
        (
            p.slots["light"].choice.as_str(),
            p.slots["light"].place.is_none()
        ),
        ("flat", true)
    );
    assert_eq!(q.slots["light"].choice, "tabled");
    assert_eq!(
        p.params["amount"],
        ParamValue::Float(3.0),
        "whole numbers become the parameter's type"
    );
    assert_eq!(q.params["amount"], ParamValue::Float(2.0));
}

#[test]
fn everything_unknown_is_told_at_once_with_its_line() {
    let nodes = "\"a\": (kind: \"pain\"),
\"b\": (kind: \"paint\", in: { \"behnd\": \"c\" }),
\"c\": (kind: \"paint\", in: { \"behind\": \"nobody\" }),
\"d\": (kind: \"paint\", in: { \"behind\": \"c.colour\" }),
\"e\": (kind: \"paint\", slots: { \"lihgt\": \"flat\" }),
\"g\": (kind: \"half\"),
\"h\": (kind: \"paint\", slots: { \"light\": 3 }),";
    let findings = resolve(&graph_text(nodes, "\"color\": \"z\""))
        .err()
        .unwrap();
    let expected = [
        ("unknown-kind", 4),
        ("unknown-port", 5),
        ("unknown-node", 6),
        ("unknown-port", 7),
        ("unknown-slot", 8),
        ("missing-input", 9),
        ("wrong-type", 10),
        ("unknown-node", 12),
    ];
    assert_eq!(codes(&findings), expected, "{findings}");
    assert!(
        findings.to_string().contains("did you mean `paint`"),
        "{findings}"
    );
}

#[test]
fn readers_of_what_was_reported_already_are_left_alone() {
    let nodes = "\"a\": (kind: \"nothing\"), \"b\": (kind: \"half\", in: { \"image\": \"a\" }),";
    assert_eq!(
        only(resolve(&graph_text(nodes, "\"color\": \"b\""))).code,
        "unknown-kind"
    );
}
