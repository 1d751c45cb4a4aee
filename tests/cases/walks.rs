//! In pairs or one by one: a walk's segments are the same.

use volgraph::Picture;
use volgraph_measure::compare_without_flip;
use volgraph_tests::repository::{VOLUMES, graph_file};
use volgraph_tests::{Stage, adapters, load, start};

const SIZE: [u32; 2] = [48, 40];

/// The picture of a ready graph, and its plan's shader says how it walks.
fn render(name: &str, backend: &str, sets: &[&str]) -> Picture {
    let scene =
        load(&graph_file(name), sets).unwrap_or_else(|findings| panic!("{name}: {findings}"));
    let mut session =
        start(scene, backend, SIZE).unwrap_or_else(|findings| panic!("{name}: {findings}"));
    let rendered = session.render();
    rendered
        .unwrap_or_else(|findings| panic!("{name}: {findings}"))
        .0
}

fn largest(name: &str, backend: &str, sets: &[&str]) -> f64 {
    let alone: Vec<&str> = [sets, &["image.slots.walk=segments"]].concat();
    let [pairs, alone] = [sets, &alone].map(|sets| render(name, backend, sets));
    compare_without_flip(&pairs, &alone).unwrap().max.error
}

/// Where rays run to their ends: but for the lengths of segments, which one by one are differences of two distances.
#[test]
fn pairs_are_what_segments_are() {
    for name in VOLUMES.iter().chain(&["mip", "minip", "average", "xray"]) {
        let is_projection = !VOLUMES.contains(name);
        for backend in adapters() {
            for step in ["image.step=1", "image.step=0.37", "image.step=9"] {
                // The nearest entry of a table of tones may be the one beside.
                let exact = if is_projection {
                    "image.slots.tone=window"
                } else {
                    "image.early_termination=0"
                };
                let sets = [step, exact];
                let error = largest(name, &backend, &sets);
                assert!(error <= 1e-5, "{name} on {backend}, {step}: {error:e}");
            }
        }
    }
}

/// Where they end early: no farther off than the light that is left.
#[test]
fn pairs_end_no_later_than_a_segment() {
    for name in VOLUMES {
        for backend in adapters() {
            let error = largest(name, &backend, &["image.early_termination=0.01"]);
            assert!(error <= 0.011, "{name} on {backend}: {error:e}");
        }
    }
}

/// That a technique knows of pairs, its file says: a surface would be lost in every second segment.
#[test]
fn pairs_cannot_be_forced_upon_a_technique() {
    let backend = &adapters()[0];
    let sets = ["image.slots.walk=pairs"];
    let scene =
        load(&graph_file("isosurface"), &sets).unwrap_or_else(|findings| panic!("{findings}"));
    let drawn = start(scene, backend, SIZE).and_then(|mut session| session.render().map(|_| ()));
    let findings = drawn.unwrap_err().to_string();
    assert!(findings.contains("@walks pairs"), "{findings}");
}

/// Where lights are is asked before their number is held against its range.
#[test]
fn as_many_lights_as_nobody_has_are_refused_at_once() {
    let sets = ["image.slots.light=phong", "image.lights=9000000000000"];
    let drawn = load(&graph_file("comparison"), &sets)
        .and_then(|scene| start(scene, &adapters()[0], SIZE).map(|_| ()));
    let findings = drawn.unwrap_err().to_string();
    assert!(findings.contains("lights"), "{findings}");
}

/// Of gradients in single floats the fourth number is the scalar: walks in pairs read both at once.
#[test]
fn scalars_beside_gradients_are_those_of_the_volume() {
    let lit = [
        "image.slots.light=phong",
        "image.slots.classify=post",
        "image.slots.gradient_storage=rgba32f",
        "image.early_termination=0",
    ];
    let mut drawn = 0;
    for (name, set) in [
        ("comparison", "image.step=0.7"),
        ("hydrogen", "image.slots.traverse=skip"),
    ] {
        let sets = [&lit[..], &[set]].concat();
        for backend in adapters() {
            // A device that cannot filter single floats says so.
            let scene = load(&graph_file(name), &sets).unwrap();
            if let Err(findings) = start(scene, &backend, SIZE) {
                let findings = findings.to_string();
                assert!(findings.contains("cannot filter"), "{findings}");
                continue;
            }
            let error = largest(name, &backend, &sets);
            assert!(error <= 1e-5, "{name} on {backend}: {error:e}");
            drawn += 1;
        }
    }
    assert!(drawn >= 2, "no adapter filters single floats");
}

/// Of gradients that somebody else stores, the fourth number is none.
#[test]
fn scalars_are_read_beside_gradients_only_where_they_are() {
    let text = std::fs::read_to_string(graph_file("comparison")).unwrap();
    let own = text
        .replace(
            r#""box": "#,
            r#""own": (kind: "gradient", in: { "volume": "volume" }), "box": "#,
        )
        .replace(
            r#""rays": "box","#,
            r#""rays": "box", "gradient_volume": "own","#,
        );
    assert!(own.contains(r#""gradient_volume""#), "{own}");
    let stage = Stage::new().with("graph.ron", own).with(
        "transfer/comparison.ron",
        std::fs::read_to_string(graph_file("transfer/comparison")).unwrap(),
    );
    let sets = [
        "image.slots.light=phong",
        "image.slots.gradient_storage=rgba16f",
    ];
    let other = [
        "image.slots.light=phong",
        "image.slots.gradient_storage=rgba32f",
    ];
    let backend = &adapters()[0];
    let [ours, theirs] =
        [sets, other].map(|sets| volgraph_tests::render(&stage, &sets, backend, SIZE).0);
    let error = compare_without_flip(&ours, &theirs).unwrap().max.error;
    assert!(error <= 1e-6, "{error:e}");
}

/// Where both are asked for at the same places, on a device that need not convert half floats: any other graph has
/// no use for twice the memory.
#[test]
fn gradients_are_stored_in_single_floats_where_that_pays() {
    let lit = ["image.slots.light=phong", "image.slots.classify=post"];
    let stored = |backend: &str, sets: &[&str], most: Option<u64>| {
        let scene = load(&graph_file("comparison"), &[&lit[..], sets].concat()).unwrap();
        let mut options = volgraph_tests::options(&[], backend, SIZE);
        options.max_resource_bytes = most;
        let gpu = volgraph_tests::gpu_alone(backend);
        let limits = options.limits(&gpu);
        let plan = scene
            .plan(
                &scene.shader_library(gpu.capabilities()),
                &limits,
                SIZE,
                false,
            )
            .unwrap_or_else(|findings| panic!("{sets:?}: {findings}"));
        let node = plan.graph.nodes.iter().find(|node| node.name == "image");
        node.unwrap().slots["gradient_storage"].choice.clone()
    };
    for backend in adapters() {
        let gpu = volgraph_tests::gpu_alone(&backend);
        let limits = gpu.limits();
        // Drivers on the processor alone are known to gain.
        assert_eq!(limits.float32_fast, gpu.adapter().class == "software");
        let choice = stored(&backend, &[], None);
        let gains = limits.float32_fast && limits.float32_filterable;
        let faster = if gains { "rgba32f" } else { "rgba16f" };
        assert_eq!(choice, faster, "{backend}");
        let others = [
            "image.slots.classify=preintegrated_2d",
            "image.slots.light=unlit",
            "image.slots.gradient_storage=rgba16f",
        ];
        for other in others {
            assert_eq!(
                stored(&backend, &[other], None),
                "rgba16f",
                "{backend}, {other}"
            );
        }
        // How rays skip and walk has nothing to do with it.
        for walk in ["image.slots.traverse=adaptive", "image.slots.walk=segments"] {
            assert_eq!(stored(&backend, &[walk], None), faster, "{backend}, {walk}");
        }
        // 128³ texels of 16 bytes are more than the user's own limit, those of 8 bytes are not.
        assert_eq!(stored(&backend, &[], Some(20 << 20)), "rgba16f");
    }
}
