//! What a graph comes to, without a device: nodes, bindings and memory follow from what the shaders use.

use naga::valid::Capabilities;
use volgraph::{
    Findings, Limits, NoProgress, Overrides, ParamOverride, Plan, Scene, ShaderFolders, registry,
};
use volgraph_graph::PlannedNode;
use volgraph_picture::{Picture, SaveOptions};
use volgraph_tests::{Stage, graph};

fn stage(slots: &str, background: &str) -> Stage {
    let camera = "orbit(azimuth: 0, elevation: 0)";
    Stage::new()
        .with_floats("v", [8, 8, 8], |x, _, _| x as f32)
        .with(
            "transfer.ron",
            "(color: (1, 1, 1), opacity: [(0, 0), (1, 0.5)])",
        )
        .with(
            "graph.ron",
            graph(
                r#"path: "v_8x8x8_float32.raw""#,
                camera,
                background,
                slots,
                "{}",
            ),
        )
}

pub fn plan(stage: &Stage, sets: &[&str]) -> Plan {
    try_plan(stage, sets, &Limits::default()).unwrap()
}

fn try_plan(stage: &Stage, sets: &[&str], limits: &Limits) -> Result<Plan, Findings> {
    let params = sets
        .iter()
        .map(|set| ParamOverride::parse(set).unwrap())
        .collect();
    let overrides = Overrides {
        params,
        ..Overrides::default()
    };
    let path = stage.path().join("graph.ron");
    let scene = Scene::load(
        &path,
        &overrides,
        &ShaderFolders::default(),
        registry(),
        &NoProgress,
    )?;
    let shaders = scene.shader_library(Capabilities::default());
    scene.plan(&shaders, limits, [64, 64], false)
}

/// Whether anything of the plan, in any of its three forms, speaks of gradients.
fn speaks_of_gradients(plan: &Plan) -> [bool; 3] {
    // Which choices the file did not make, and parameters, are no nodes, textures or bindings.
    let lines = |text: String| {
        text.lines()
            .any(|line| line.contains("gradient") && !line.contains("slot"))
    };
    let allocations = plan
        .allocations
        .iter()
        .any(|a| a.users.iter().any(|user| user.contains("gradient")));
    [lines(plan.to_text()), lines(plan.to_dot()), allocations]
}

fn names(plan: &Plan) -> Vec<String> {
    plan.nodes().into_iter().map(|node| node.name).collect()
}

#[test]
fn an_unlit_graph_has_no_gradient_node_texture_or_binding_and_phong_has() {
    let stage = stage("{}", "{}");
    let unlit = plan(&stage, &[]);
    assert_eq!(
        speaks_of_gradients(&unlit),
        [false; 3],
        "{}",
        unlit.to_text()
    );
    assert!(!unlit.to_json()["nodes"].to_string().contains("gradient"));
    let phong = plan(&stage, &["image.slots.light=phong"]);
    assert_eq!(
        speaks_of_gradients(&phong),
        [true; 3],
        "{}",
        phong.to_text()
    );
    let node = |name: &str| {
        phong
            .nodes()
            .into_iter()
            .find(|node: &PlannedNode| node.name == name)
            .unwrap()
    };
    assert_eq!(
        node("image.gradient").called_for_by.as_deref(),
        Some("image (binding gradient_volume)")
    );
    let is_bound = |entry: &str| {
        node("image").entries[entry]
            .iter()
            .any(|binding| binding.name == "gradient_volume")
    };
    assert!(is_bound("raycast_fragment") && is_bound("raycast_compute"));
    // Gradients from the field itself need no node.
    let central = plan(
        &stage,
        &["image.slots.light=phong", "image.slots.gradient=central"],
    );
    assert!(!names(&central).contains(&"image.gradient".to_owned()));
}

#[test]
fn tables_are_made_for_the_classification_that_reads_them() {
    let stage = stage("{}", "{}");
    let has = |sets: &[&str], name: &str| names(&plan(&stage, sets)).contains(&name.to_owned());
    let sampled = ["image.slots.classify=post"];
    assert!(has(&sampled, "image.transfer_table") && !has(&sampled, "image.preintegration"));
    let preintegrated = ["image.slots.classify=preintegrated_2d"];
    assert!(
        !has(&preintegrated, "image.transfer_table") && has(&preintegrated, "image.preintegration")
    );
    let halves = ["image.slots.classify=second_order"];
    assert!(has(&halves, "image.preintegration_half") && !has(&halves, "image.preintegration"));
    let integrals = ["image.slots.classify=integral_1d"];
    assert!(has(&integrals, "image.integral_table") && !has(&integrals, "image.preintegration"));
}

#[test]
fn an_image_background_that_no_output_needs_is_culled() {
    let image = r#""backdrop": image(path: "backdrop.png"),"#;
    let stage = stage("{}", r#"{ "pattern": "image" }"#);
    let text = std::fs::read_to_string(stage.path().join("graph.ron")).unwrap();
    let text = text
        .replace("sources: {", &format!("sources: {{ {image}"))
        .replace(
            "kind: \"background\",",
            "kind: \"background\", in: { \"image\": \"backdrop\" },",
        );
    let unused = text.replace(", \"behind\": \"background\"", "");
    assert_ne!(text, unused);
    let picture = Picture::from_color(2, 2, vec![[1.0; 4]; 4]).unwrap();
    let _ = picture
        .save(&stage.path().join("backdrop.png"), SaveOptions::default())
        .unwrap();
    let stage = stage.with("graph.ron", &text);
    let used = plan(&stage, &[]);
    assert!(names(&used).contains(&"background.image_texture".to_owned()));
    assert!(used.culled.is_empty(), "{:?}", used.culled);
    let stage = stage.with("graph.ron", &unused);
    let culled = plan(&stage, &[]);
    assert_eq!(
        culled.culled,
        ["backdrop", "background", "background.image_texture"]
    );
    assert!(
        names(&culled)
            .iter()
            .all(|name| !name.starts_with("background"))
    );
    // The file's own pattern needs no image either.
    let stage = stage.with("graph.ron", &text);
    let checker = plan(&stage, &["background.pattern=checker"]);
    assert!(!names(&checker).contains(&"background.image_texture".to_owned()));
}

#[test]
fn layers_cost_memory_only_where_somebody_wants_them() {
    let stage = stage("{}", "{}");
    let bytes = |plan: &Plan| {
        plan.allocations
            .iter()
            .map(|a| a.resource.bytes())
            .sum::<u64>()
    };
    let color = plan(&stage, &[]);
    let text = std::fs::read_to_string(stage.path().join("graph.ron")).unwrap();
    let wanted = text.replace(
        "\"image.color\"",
        "\"image.color\", \"depth\": \"image.depth\"",
    );
    let stage = stage.with("graph.ron", wanted);
    // Four bytes a pixel.
    assert_eq!(bytes(&plan(&stage, &[])) - bytes(&color), 64 * 64 * 4);
}

#[test]
fn the_drawing_and_the_json_hold_the_same_graph() {
    let plan = plan(&stage("{ \"light\": \"phong\" }", "{}"), &[]);
    let json = plan.to_json();
    let dot = plan.to_dot();
    // Every edge of the JSON is drawn.
    for node in json["nodes"].as_array().unwrap() {
        for (port, from) in node["inputs"].as_object().unwrap() {
            let from = from.as_str().unwrap();
            let writer = json["nodes"].as_array().unwrap().iter().find_map(|writer| {
                let name = writer["name"].as_str().unwrap();
                from.strip_prefix(name)
                    .is_some_and(|rest| rest.matches('.').count() == 1)
                    .then_some(name)
            });
            let edge = format!(
                "\"{}\" -> {} [label=\"{port}\"]",
                writer.unwrap_or(from),
                node["name"]
            );
            assert!(dot.contains(&edge), "{edge} is not in\n{dot}");
        }
    }
    assert_eq!(dot.matches('{').count(), dot.matches('}').count());
    assert_eq!(
        json["conventions"].as_object().unwrap().len(),
        volgraph_graph::print::CONVENTIONS.len()
    );
}

#[test]
fn the_work_of_a_node_without_a_shader_is_told_by_its_slots() {
    // Where shaders cannot write 3D textures, gradients are made without one.
    let limits = Limits {
        storage_3d: false,
        ..Limits::default()
    };
    let stage = stage(r#"{ "light": "phong" }"#, "{}");
    let gradient = |method: &str| {
        let set = format!("image.slots.gradient_method={method}");
        let plan = try_plan(&stage, &[&set], &limits).unwrap();
        let id = plan.graph.find("image.gradient").unwrap();
        assert!(plan.graph.nodes[id].program.is_none());
        plan.fingerprints(&plan.view())[&id]
    };
    assert_eq!(gradient("central"), gradient("central"));
    assert_ne!(gradient("central"), gradient("sobel"));
}

#[test]
fn a_table_of_another_transfer_function_is_refused() {
    let text = |of: &str| {
        graph(
            r#"path: "v_8x8x8_float32.raw""#,
            "orbit(azimuth: 0, elevation: 0)",
            "{}",
            r#"{ "classify": "post" }"#,
            "{}",
        )
        .replace(
            r#""colors": transfer"#,
            r#""other": transfer(path: "transfer.ron"), "colors": transfer"#,
        )
        .replace(
            r#""box": "#,
            &format!(r#""table": (kind: "transfer_table", in: {{ "transfer": "{of}" }}), "box": "#),
        )
        .replace(
            r#""rays": "box""#,
            r#""rays": "box", "transfer_table": "table""#,
        )
    };
    let planned = |of: &str| {
        try_plan(
            &stage("{}", "{}").with("graph.ron", text(of)),
            &[],
            &Limits::default(),
        )
    };
    planned("colors").unwrap();
    let refused = planned("other").err().unwrap();
    assert!(
        refused
            .into_iter()
            .all(|finding| finding.code == "input-mismatch")
    );
}
