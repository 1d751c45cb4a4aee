use std::path::PathBuf;

use proptest::prelude::*;

use super::*;

const GRAPH: &str = r#"// which
(
    sources: { "v": analytic(field: "sphere"), "t": transfer(path: 't_is_no_text') },
    nodes: {
        "image": (kind: "raycast", // the, "one": that
                  in: { "volume": "v", },
                  params: {
                      "step": 0.50, // long
                      "light": (1, 0, 0), /* { */
                  }),
        "box": (kind: "proxy_box"),
    },
    outputs: { "color": "image.color" },
)
"#;

fn graph() -> String {
    GRAPH.replace("'t_is_no_text'", r##"r#"a".ron"#"##)
}

fn param(target: &str, name: &str, value: Option<ParamValue>) -> Edit {
    let (target, name) = (target.to_owned(), name.to_owned());
    Edit::Param {
        target,
        name,
        value,
    }
}

fn slot(node: &str, slot: &str, choice: Option<&str>) -> Edit {
    Edit::Slot {
        node: node.to_owned(),
        slot: slot.to_owned(),
        choice: choice.map(|choice| ParamValue::Text(choice.to_owned())),
    }
}

fn edited(text: &str, edits: &[Edit]) -> String {
    apply_edits(text, Path::new("t.ron"), edits).unwrap_or_else(|found| panic!("{found}"))
}

/// What of a text was replaced by what, once.
fn replaced(from: &str, to: &str) -> String {
    let graph = graph();
    assert_eq!(graph.matches(from).count(), 1, "{from}");
    graph.replace(from, to)
}

#[test]
fn a_value_changes_where_it_stands_and_nothing_else_does() {
    let float = |value| Some(ParamValue::Float(value));
    assert_eq!(
        edited(&graph(), &[param("image", "step", float(0.25))]),
        replaced("0.50", "0.25")
    );
    // As it is already: not even its digits change.
    assert_eq!(
        edited(&graph(), &[param("image", "step", float(0.5))]),
        graph()
    );
    let light = Some(ParamValue::Vector(vec![0.0, 1.5, 0.0]));
    assert_eq!(
        edited(&graph(), &[param("image", "light", light)]),
        replaced("(1, 0, 0)", "(0.0, 1.5, 0.0)")
    );
    let path = Some(ParamValue::Text("a \"b\"\\\n.ron".to_owned()));
    assert_eq!(
        edited(&graph(), &[param("t", "path", path)]),
        replaced(r##"r#"a".ron"#"##, r#""a \"b\"\\\n.ron""#)
    );
}

#[test]
fn what_is_new_is_laid_out_as_its_neighbours() {
    let one = Some(ParamValue::Int(1));
    assert_eq!(
        edited(&graph(), &[param("image", "stage", one.clone())]),
        replaced(
            "/* { */\n",
            "/* { */\n                      \"stage\": 1,\n"
        )
    );
    assert_eq!(
        edited(&graph(), &[param("v", "n", one.clone())]),
        replaced("\"sphere\"", "\"sphere\", n: 1")
    );
    assert_eq!(
        edited(&graph(), &[slot("box", "technique", Some("mip"))]),
        replaced(
            "\"proxy_box\"",
            "\"proxy_box\", slots: { \"technique\": \"mip\" }"
        )
    );
    let camera = "orbit(azimuth: 40)";
    assert_eq!(
        edited(&graph(), &[Edit::Camera(Some(camera.to_owned()))]),
        replaced(
            "},\n    nodes",
            "},\n    camera: orbit(azimuth: 40),\n    nodes"
        )
    );
    let bare = graph().replace("analytic(field: \"sphere\")", "analytic");
    assert!(edited(&bare, &[param("v", "n", one)]).contains("\"v\": analytic(n: 1),"));
    let volume = Edit::Volume {
        source: "v".to_owned(),
        path: "a.nrrd".to_owned(),
    };
    assert_eq!(
        edited(&graph(), &[volume]),
        replaced("analytic(field: \"sphere\")", "volume(path: \"a.nrrd\")")
    );
}

#[test]
fn what_is_taken_out_leaves_its_neighbours_and_comments() {
    let windows = graph().replace('\n', "\r\n");
    for text in [graph(), windows] {
        let step = edited(&text, &[param("image", "step", None)]);
        assert!(!step.contains("0.50") && step.contains("// long"));
        let both = edited(&step, &[param("image", "light", None)]);
        assert_eq!(layout::comments(&both), layout::comments(&text));
        let field = edited(&text, &[param("v", "field", None)]);
        assert!(field.contains("analytic()"), "{field}");
        let again = [
            slot("box", "a", Some("x")),
            slot("box", "b", Some("y")),
            slot("box", "b", None),
        ];
        assert!(edited(&text, &again).contains("slots: { \"a\": \"x\" })"));
        // What is not there is out already.
        assert_eq!(edited(&text, &[slot("box", "a", None)]), text);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let code = |edit| {
        let found = apply_edits(&graph(), Path::new("t.ron"), &[edit]).unwrap_err();
        found.sorted()[0].code
    };
    assert_eq!(code(param("imag", "step", None)), "unknown-node");
    assert_eq!(code(slot("v", "technique", Some("mip"))), "unknown-node");
    assert_eq!(code(Edit::Camera(Some("orbit(".to_owned()))), "ron-syntax");
    // A field that no RON can name, and numbers that no graph may hold.
    let one = || Some(ParamValue::Int(1));
    assert_eq!(code(param("v", "a b", one())), "bad-edit");
    assert_eq!(code(param("v", "a: 1, b", one())), "bad-edit");
    let nan = Some(ParamValue::Float(f64::NAN));
    assert_eq!(code(param("image", "step", nan)), "bad-edit");
}

/// The ready graphs.
fn ready() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../graphs");
    let mut folders = vec![root];
    let mut graphs = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|it| it == "ron") {
                let text = std::fs::read_to_string(&path).unwrap();
                if read::graph(&path, &text).is_ok() {
                    graphs.push((path, text));
                }
            }
        }
    }
    graphs.sort();
    assert!(graphs.len() > 50);
    graphs
}

fn any_value() -> impl Strategy<Value = Option<ParamValue>> {
    prop_oneof![
        Just(None),
        any::<bool>().prop_map(|it| Some(ParamValue::Bool(it))),
        any::<i64>().prop_map(|it| Some(ParamValue::Int(it))),
        (-1e300..1e300_f64).prop_map(|it| Some(ParamValue::Float(it))),
        ".*".prop_map(|it| Some(ParamValue::Text(it))),
        proptest::collection::vec(-1e9..1e9_f64, 0..5).prop_map(|it| Some(ParamValue::Vector(it))),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// [`apply_edits`] itself refuses a text that means anything else; here it may not refuse, and comments stay.
    #[test]
    fn any_edits_of_any_ready_graph_hold_and_keep_its_comments(
        seeds in proptest::collection::vec((any::<usize>(), any::<usize>(), 0..6_u8, any_value()), 1..8),
    ) {
        for (path, text) in ready() {
            let desc = read::graph(&path, &text).unwrap();
            let pick = |of: Vec<&String>, seed: usize| of.get(seed % of.len().max(1)).map(|it| (*it).clone());
            let edits: Vec<Edit> = seeds.iter().map(|(who, what, kind, value)| {
                let node = pick(desc.nodes.keys().collect(), *who).unwrap();
                let source = pick(desc.sources.keys().collect(), *who).unwrap_or_else(|| node.clone());
                let of = |map: &indexmap::IndexMap<String, ParamDesc>, target: &str| {
                    let own = pick(map.keys().collect(), *what).filter(|_| what % 3 > 0);
                    param(target, &own.unwrap_or_else(|| "new_one".to_owned()), value.clone())
                };
                match kind {
                    0 | 1 => of(&desc.nodes[&node].params, &node),
                    2 => {
                        let own = pick(desc.nodes[&node].slots.keys().collect(), *what);
                        slot(&node, &own.unwrap_or_else(|| "new \"one\"".to_owned()), value.as_ref().map(|_| "mip"))
                    }
                    3 => Edit::Camera(value.as_ref().map(|_| "look_at(eye: (1, 2, 3))".to_owned())),
                    4 if desc.sources.contains_key(&source) => of(&desc.sources[&source].params, &source),
                    _ if desc.sources.contains_key(&source) => Edit::Volume { source, path: "a.nrrd".to_owned() },
                    _ => of(&desc.nodes[&node].params, &node),
                }
            }).collect();
            let after = apply_edits(&text, &path, &edits);
            prop_assert!(after.is_ok(), "{}: {edits:?}: {}", path.display(), after.unwrap_err());
            let after = after.unwrap();
            prop_assert_eq!(layout::comments(&after), layout::comments(&text), "{}", path.display());
            // Again nothing changes.
            prop_assert_eq!(&apply_edits(&after, &path, &edits[edits.len() - 1..]).unwrap(), &after);
        }
    }
}
