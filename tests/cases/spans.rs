//! Spans that one ray finds for a tile of pixels leave out nothing of what any ray of the tile sees.

use volgraph_measure::compare_without_flip;
use volgraph_tests::{Stage, adapters, load, render, start};

/// Thin sheets across x, more than a tile has spans, and a ball.
fn sheets() -> Stage {
    let field = |x: u32, y: u32, z: u32| {
        let is_sheet = x % 16 == 5 && (y + z) % 24 > 3;
        let square: i64 = [(x, 130), (y, 12), (z, 9)]
            .iter()
            .map(|(at, centre)| (i64::from(*at) - centre).pow(2))
            .sum();
        if is_sheet {
            0.6
        } else {
            (1.0 - (square as f32).sqrt() / 7.0).max(0.0)
        }
    };
    Stage::new()
        .with_floats("v", [256, 24, 20], field)
        .with(
            "t.ron",
            "(points: [(at: 0.1, color: (1, 0.5, 0), opacity: 0), (at: 1, color: (0, 0.5, 1), opacity: 0.4)])",
        )
        .with("graph.ron", graph("orbit(azimuth: 90, elevation: 3)"))
}

fn graph(camera: &str) -> String {
    format!(
        r#"(
    sources: {{
        "v": volume(path: "v_256x24x20_float32.raw", spacing: (1, 1.5, 0.7)),
        "t": transfer(path: "t.ron"),
    }},
    camera: {camera},
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "box" }},
                  slots: {{ "classify": "post", "traverse": "skip" }}, params: {{ "step": 0.5, "early_termination": 0 }}),
    }},
    outputs: {{ "color": "image.color", "samples": "image.samples" }},
)"#
    )
}

/// Along the sheets and across them, from within, from afar, with parallel rays; pictures smaller than a tile, and of
/// sizes that tiles do not divide.
#[test]
fn no_ray_of_a_tile_loses_anything() {
    for camera in [
        "orbit(azimuth: 90, elevation: 3)",
        "orbit(azimuth: 35, elevation: 20, zoom: 3)",
        "orbit(azimuth: 80, elevation: -15, zoom: 0.1)",
        "look_at(eye: (10, 2, 1), target: (100, 4, 0), up: (0, 1, 0), fov_y: 100)",
        "look_at(eye: (-300, 20, 30), target: (0, 0, 0), up: (0, 1, 0), projection: orthographic, height: 40)",
    ] {
        let stage = sheets().with("graph.ron", graph(camera));
        for size in [[1, 1], [3, 2], [37, 21], [96, 64]] {
            for backend in adapters() {
                for brick in [
                    "image.brick_size=2",
                    "image.brick_size=4",
                    "image.brick_size=16",
                ] {
                    let of = |traverse: &str| {
                        let traverse = format!("image.slots.traverse={traverse}");
                        render(&stage, &[&traverse, brick], &backend, size).0
                    };
                    let [plain, leapt] = ["uniform", "skip"].map(of);
                    let error = compare_without_flip(&plain, &leapt).unwrap().max.error;
                    assert!(
                        error <= 1e-6,
                        "{camera}, {size:?} on {backend}, {brick}: {error:e}"
                    );
                }
            }
        }
    }
}

/// Where tiles are narrower than bricks no ray looks for itself, and spans alone spare the samples of what is empty.
#[test]
fn spans_are_as_short_as_a_tile_lets_them() {
    let camera = "look_at(eye: (-60, 40, 200), target: (0, 0, 0), up: (0, 1, 0), projection: orthographic, height: 24)";
    let stage = sheets().with("graph.ron", graph(camera));
    for backend in adapters() {
        let samples = |traverse: &str| {
            let traverse = format!("image.slots.traverse={traverse}");
            let scene = load(
                &stage.path().join("graph.ron"),
                &[&traverse, "image.brick_size=2"],
            );
            let mut session = start(scene.unwrap(), &backend, [160, 120]).unwrap();
            session.draw().unwrap();
            let samples = session.read("samples").unwrap();
            samples.color.iter().map(|it| f64::from(it[0])).sum::<f64>()
        };
        let [plain, leapt] = ["uniform", "skip"].map(samples);
        assert!(plain > 1.5 * leapt, "{backend}: {plain} to {leapt}");
    }
}
