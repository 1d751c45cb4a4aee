//! Segments longer than a step are wrong by no more than is stated, and save samples.

use volgraph::{ParamOverride, Picture, Scene};
use volgraph_measure::compare_without_flip;
use volgraph_tests::repository::{VOLUMES, graph_file};
use volgraph_tests::{Stage, adapters, load, start};

const SIZE: [u32; 2] = [40, 36];

/// The picture, and the samples of each ray where the graph has that output.
fn render(scene: &Scene, backend: &str, typed: &[&str]) -> (Picture, Vec<f64>) {
    let parse = |typed: &&str| ParamOverride::parse(typed).unwrap();
    let sets: Vec<ParamOverride> = typed.iter().map(parse).collect();
    let scene = scene
        .with_sets(&sets)
        .unwrap_or_else(|findings| panic!("{findings}"));
    let mut session = start(scene, backend, SIZE).unwrap_or_else(|findings| panic!("{findings}"));
    let picture = session
        .render()
        .unwrap_or_else(|findings| panic!("{findings}"))
        .0;
    let samples = session.read("samples").map_or(Vec::new(), |samples| {
        let color = samples.color.into_iter();
        color.map(|it| f64::from(it[0])).collect()
    });
    (picture, samples)
}

/// The square of the distance from the middle of 48³, under a transfer function that is linear in it: segments are wrong by
/// the second derivative alone, which is the same everywhere, and all into one direction.
fn bowl(classify: &str) -> Stage {
    let field = |x: u32, y: u32, z: u32| {
        let squares = [x, y, z].map(|i| (f64::from(i) - 23.5).powi(2));
        squares.iter().sum::<f64>() as f32
    };
    Stage::new()
        .with_floats("v", [48; 3], field)
        .with(
            "transfer.ron",
            "(domain: data, points: [(at: -2000, color: (1, 1, 1), opacity: 0), (at: 4000, color: (1, 1, 1), opacity: 0.006)])",
        )
        .with(
            "graph.ron",
            format!(
                r#"(
    sources: {{ "v": volume(path: "v_48x48x48_float32.raw"), "t": transfer(path: "transfer.ron") }},
    camera: orbit(azimuth: 20, elevation: 30),
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "box" }},
                  slots: {{ "classify": "{classify}" }}, params: {{ "step": 0.25, "early_termination": 0.0 }}),
    }},
    outputs: {{ "color": "image.color", "samples": "image.samples" }},
)"#
            ),
        )
}

/// The bound is `h³/8` times 3.46 (the Frobenius norm of the second derivatives) where a segment's true error is `h³/24`
/// times 2; lengths are powers of two, so up to eight times less; and it counts emission and attenuation, of which this
/// matter has hardly any. So the true error is between 1/160 and 1/5 of what is stated.
#[test]
fn longer_segments_are_wrong_by_no_more_than_stated_and_by_no_less_than_they_may() {
    for classify in ["post", "preintegrated_3d"] {
        let stage = bowl(classify);
        let scene = load(&stage.path().join("graph.ron"), &[]).unwrap();
        for backend in adapters() {
            let (plain, all) = render(&scene, &backend, &["image.slots.traverse=uniform"]);
            for tolerance in [2e-6, 6e-5] {
                let tolerance_text = format!("image.step_tolerance={tolerance}");
                let sets = ["image.slots.traverse=adaptive", &tolerance_text];
                let (picture, samples) = render(&scene, &backend, &sets);
                let error = compare_without_flip(&picture, &plain).unwrap().max.error;
                let most = samples.iter().fold(0.0, |a: f64, b| a.max(*b));
                let stated = tolerance * most;
                let case = format!(
                    "{classify} at {tolerance} on {backend}: {error:e} of {stated:e}, {most} samples"
                );
                assert!(error <= stated, "{case}");
                assert!(error >= stated / 160.0, "{case}");
                let saved = samples.iter().sum::<f64>() / all.iter().sum::<f64>();
                assert!(saved < 0.6, "{case}: {saved}");
            }
        }
    }
}

#[test]
fn without_tolerance_the_picture_is_that_of_whole_steps() {
    let sets = [
        "image.slots.traverse=adaptive",
        "image.step_tolerance=0.000000001",
    ];
    // In pairs rays would end a segment later.
    let alone = "image.slots.walk=segments";
    for name in VOLUMES {
        let scene = load(&graph_file(name), &[]).unwrap_or_else(|findings| panic!("{findings}"));
        for backend in adapters() {
            let (plain, _) = render(&scene, &backend, &["image.slots.traverse=uniform", alone]);
            let (picture, _) = render(&scene, &backend, &sets);
            let error = compare_without_flip(&picture, &plain).unwrap().max.error;
            assert!(error <= 1e-6, "{name} on {backend}: {error:e}");
        }
    }
}

#[test]
fn ready_graphs_stay_within_what_is_stated() {
    let tolerance = 1e-3;
    let sets = [
        "image.slots.traverse=adaptive",
        "image.step_tolerance=0.001",
    ];
    for name in VOLUMES {
        let scene = load(&graph_file(name), &[]).unwrap_or_else(|findings| panic!("{findings}"));
        for backend in adapters() {
            let (plain, _) = render(&scene, &backend, &["image.slots.traverse=uniform"]);
            let (picture, _) = render(&scene, &backend, &sets);
            let found = compare_without_flip(&picture, &plain).unwrap();
            // No ray of them has more segments than this; and no picture is nearly as wrong.
            let case = format!("{name} on {backend}: {found:?}");
            assert!(found.max.error <= 200.0 * tolerance, "{case}");
            assert!(found.rmse <= tolerance, "{case}");
        }
    }
}
