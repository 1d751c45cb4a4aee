//! Extents, limits, and who shares memory with whom.

use volgraph_graph::{Limits, Plan, ResourceKind};

use crate::{graph_text, id, only, plan};

fn extent(plan: &Plan, node: &str, port: &str) -> [u32; 3] {
    match plan.resources[&(id(&plan.graph, node), port.to_owned())] {
        ResourceKind::Texture { extent, .. } => extent,
        ResourceKind::Buffer { .. } => panic!("a buffer"),
    }
}

#[test]
fn sizes_are_absolute_or_follow_the_view_or_an_input() {
    let nodes = "\"p\": (kind: \"paint\", in: { \"volume\": \"f\" }, slots: { \"light\": \"tabled\" }),
        \"h\": (kind: \"half\", in: { \"image\": \"p\" }), \"hh\": (kind: \"half\", in: { \"image\": \"h\" }),";
    let plan = plan(
        &graph_text(nodes, "\"color\": \"hh\""),
        [101, 2],
        &Limits::default(),
    )
    .unwrap();
    assert_eq!(extent(&plan, "p.table", "table"), [64, 1, 1]);
    assert_eq!(extent(&plan, "p", "color"), [101, 2, 1]);
    // Rounded, and never less than one texel.
    assert_eq!(extent(&plan, "h", "color"), [51, 1, 1]);
    assert_eq!(extent(&plan, "hh", "color"), [26, 1, 1]);
    let is_sized = |port: &str| {
        plan.resources
            .contains_key(&(id(&plan.graph, "p"), port.to_owned()))
    };
    assert!(
        is_sized("color") && !is_sized("depth"),
        "what nobody reads is not made"
    );
}

#[test]
fn limits_are_named_with_what_was_asked() {
    let text = graph_text("\"p\": (kind: \"paint\"),", "\"color\": \"p\"");
    let finding = only(plan(&text, [8193, 8], &Limits::default()));
    assert_eq!(
        (finding.code, finding.place.unwrap().line),
        ("over-limit", 4)
    );
    for part in ["max_texture_dimension_2d", "8192", "8193"] {
        assert!(finding.message.contains(part), "{}", finding.message);
    }
    plan(&text, [8192, 8], &Limits::default()).unwrap();
    let tight = Limits {
        max_resource_bytes: 64 * 64 * 16 - 1,
        ..Limits::default()
    };
    assert_eq!(only(plan(&text, [64, 64], &tight)).code, "over-limit");
    plan(&text, [64, 63], &tight).unwrap();
}

#[test]
fn the_bytes_of_the_largest_texture_do_not_overflow() {
    let format = wgpu_types::TextureFormat::Rgba32Float;
    let huge = ResourceKind::Texture {
        dimensions: 3,
        extent: [u32::MAX; 3],
        format,
    };
    assert_eq!(huge.bytes(), u64::MAX);
}

/// A chain over the camera's pose: each node's picture is as large as the one before.
fn chain(kinds: &[&str]) -> Plan {
    let mut nodes = "\"n0\": (kind: \"paint\", slots: { \"light\": \"posed\" }),".to_owned();
    for (i, kind) in kinds.iter().enumerate() {
        nodes += &match *kind {
            "half" => format!(
                "\"n{}\": (kind: \"half\", in: {{ \"image\": \"n{i}\" }}),",
                i + 1
            ),
            _ => format!(
                "\"n{}\": (kind: \"overlay\", in: {{ \"image\": \"n{i}\" }}),",
                i + 1
            ),
        };
    }
    plan(
        &graph_text(&nodes, &format!("\"color\": \"n{}\"", kinds.len())),
        [64, 64],
        &Limits::default(),
    )
    .unwrap()
}

fn users(plan: &Plan) -> Vec<Vec<String>> {
    plan.allocations
        .iter()
        .map(|allocation| allocation.users.clone())
        .collect()
}

#[test]
fn a_transient_picture_whose_life_is_over_gives_its_memory_away() {
    let plan = chain(&["overlay", "overlay", "overlay"]);
    // Each reads its neighbour alone, so two pictures take turns.
    assert_eq!(
        users(&plan),
        [["n0.color", "n2.color"], ["n1.color", "n3.color"]]
    );
}

#[test]
fn memory_is_not_shared_with_what_is_read_later_or_differs_or_is_wanted() {
    let differs = chain(&["half", "overlay"]);
    // n0 and n2 are as large, and n0's life is over; n1 is smaller.
    assert_eq!(
        users(&differs),
        [vec!["n0.color", "n2.color"], vec!["n1.color"]]
    );
    let nodes = "\"a\": (kind: \"paint\", slots: { \"light\": \"posed\" }),
        \"b\": (kind: \"overlay\", in: { \"image\": \"a\" }), \"c\": (kind: \"overlay\", in: { \"image\": \"b\" }),";
    let wanted = plan(
        &graph_text(nodes, "\"a\": \"a\", \"c\": \"c\""),
        [64, 64],
        &Limits::default(),
    )
    .unwrap();
    assert_eq!(
        wanted.allocations.len(),
        3,
        "output `a` lives to the end: {:?}",
        users(&wanted)
    );
    let nodes = "\"a\": (kind: \"paint\", slots: { \"light\": \"posed\" }),
        \"b\": (kind: \"overlay\", in: { \"image\": \"a\" }),
        \"c\": (kind: \"overlay\", in: { \"image\": \"b\" }),
        \"d\": (kind: \"overlay\", in: { \"image\": \"c\", \"other\": \"a\" }),";
    let later = plan(
        &graph_text(nodes, "\"d\": \"d\""),
        [64, 64],
        &Limits::default(),
    )
    .unwrap();
    assert_eq!(
        users(&later),
        [vec!["a.color"], vec!["b.color", "d.color"], vec!["c.color"]]
    );
}

#[test]
fn what_does_not_follow_the_camera_is_kept_and_shares_nothing() {
    let nodes = "\"a\": (kind: \"paint\"), \"b\": (kind: \"paint\", in: { \"behind\": \"a\" }, slots: { \"light\": \"over\" }),
        \"c\": (kind: \"paint\", in: { \"behind\": \"b\" }, slots: { \"light\": \"over\" }),";
    let plan = plan(
        &graph_text(nodes, "\"color\": \"c\""),
        [64, 64],
        &Limits::default(),
    )
    .unwrap();
    assert!(plan.following_camera.is_empty());
    assert_eq!(plan.allocations.len(), 3);
    assert!(
        plan.allocations
            .iter()
            .all(|allocation| !allocation.is_transient)
    );
}
