//! Spans that one ray finds for a tile of pixels leave out nothing of what any ray of the tile sees.

use std::collections::BTreeSet;

use volgraph::{Change, Outcome};
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
    graph_of(camera, r#""classify": "post""#)
}

fn graph_of(camera: &str, slots: &str) -> String {
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
                  slots: {{ {slots}, "traverse": "skip" }}, params: {{ "step": 0.5, "early_termination": 0 }}),
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
                for (brick, shaders) in [
                    (1, "compute"),
                    (2, "fragment"),
                    (4, "compute"),
                    (16, "compute"),
                ] {
                    let brick = format!("image.brick_size={brick}");
                    let shaders = format!("image.stage={shaders}");
                    let of = |traverse: &str| {
                        let traverse = format!("image.slots.traverse={traverse}");
                        render(&stage, &[&traverse, &brick, &shaders], &backend, size).0
                    };
                    let [plain, leapt] = ["uniform", "skip"].map(of);
                    let error = compare_without_flip(&plain, &leapt).unwrap().max.error;
                    assert!(
                        error <= 1e-6,
                        "{camera}, {size:?} on {backend}, {brick}, {shaders}: {error:e}"
                    );
                }
            }
        }
    }
}

/// Scalars are made of the voxels around: a sheet of one voxel is seen for as far on either side of it, in bricks that
/// do not have it, too. So close that tiles and steps are far smaller than voxels, along a ray that goes in, and out.
#[test]
fn bricks_end_where_scalars_are_made_of_other_voxels() {
    let camera = "look_at(eye: (60, 0.2, 0.1), target: (0, 0, 0), up: (0, 1, 0), projection: orthographic, height: 0.2)";
    let graph = graph_of(camera, r#""classify": "preintegrated_2d""#)
        .replace("v_256x24x20", "v_18x4x4")
        .replace("\"step\": 0.5", "\"step\": 0.02");
    for sheet in 0..6 {
        let field = |x: u32, _: u32, _: u32| if x == 5 + sheet { 1.0 } else { 0.0 };
        let stage = sheets()
            .with_floats("v", [18, 4, 4], field)
            .with("graph.ron", &graph);
        for backend in adapters() {
            for brick in [1, 2, 3, 4] {
                let brick = format!("image.brick_size={brick}");
                let of = |traverse: &str| {
                    let traverse = format!("image.slots.traverse={traverse}");
                    render(&stage, &[&traverse, &brick], &backend, [24, 16]).0
                };
                let [plain, leapt] = ["uniform", "skip"].map(of);
                let error = compare_without_flip(&plain, &leapt).unwrap().max.error;
                assert!(error <= 1e-6, "{sheet} on {backend}, {brick}: {error:e}");
            }
        }
    }
}

/// Surfaces that lie in the very plane where a brick ends, up to rounding: steps end in that plane, and leaps before it. From either
/// side: into the solid, and out of it.
#[test]
fn surfaces_where_bricks_end_have_no_holes() {
    let level = 0.5_f32;
    let below = f32::from_bits(level.to_bits() - 1);
    for (at, spacing) in [(4, 0.7), (12, 0.3), (28, 1.1), (44, 0.9), (60, 0.013)] {
        let field = |_: u32, _: u32, z: u32| match z.cmp(&at) {
            std::cmp::Ordering::Less => 0.0,
            std::cmp::Ordering::Equal => below,
            std::cmp::Ordering::Greater => 1.0,
        };
        for (technique, params, side) in [
            ("isosurface", r#""isovalue": 0.5"#, -1.0),
            (
                "isosurfaces_translucent",
                r#""surfaces": 1, "isovalue_1": 0.5"#,
                -1.0,
            ),
            (
                "isosurfaces_translucent",
                r#""surfaces": 1, "isovalue_1": 0.5"#,
                1.0,
            ),
        ] {
            let graph = format!(
                r#"(
    sources: {{ "v": volume(path: "v_6x5x65_float32.raw", node_centred: true, spacing: ({spacing}, {spacing}, {spacing})) }},
    camera: look_at(eye: (0, 0, {eye}), target: (0, 0, 0), up: (0, 1, 0), projection: orthographic, height: {height}),
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "rays": "box" }}, slots: {{ "technique": "{technique}" }},
                  params: {{ "step": 1, "refinement": "linear", {params} }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#,
                eye = 97.0 * side * spacing,
                height = 3.0 * spacing,
            );
            let stage = Stage::new()
                .with_floats("v", [6, 5, 65], field)
                .with("graph.ron", &graph);
            for backend in adapters() {
                for brick in [3, 4] {
                    let brick = format!("image.brick_size={brick}");
                    let of = |traverse: &str| {
                        let traverse = format!("image.slots.traverse={traverse}");
                        render(&stage, &[&traverse, &brick], &backend, [96, 64]).0
                    };
                    let [plain, leapt] = ["uniform", "skip"].map(of);
                    let error = compare_without_flip(&plain, &leapt).unwrap().max.error;
                    assert!(
                        error <= 1e-6,
                        "{technique} {side} at {at} of {spacing} on {backend}, {brick}: {error:e}"
                    );
                }
            }
        }
    }
}

/// Segments that absorb nothing are not lit, whatever the quadrature and however many intervals absorb; light that is itself a
/// walk, and nothing to see at all.
#[test]
fn what_absorbs_is_lit_as_without_skipping() {
    let camera = "orbit(azimuth: 35, elevation: 20, zoom: 2)";
    let peak = |at: f64| {
        format!(
            "(at: {}, color: (1, {at}, 0.2), opacity: 0), (at: {at}, color: (1, {at}, 0.2), opacity: 0.8), (at: {}, color: (1, {at}, 0.2), opacity: 0),",
            at - 0.02,
            at + 0.02
        )
    };
    let peaks: String = [0.1, 0.2, 0.35, 0.5, 0.6, 0.75, 0.9].map(peak).concat();
    let clear = "(at: 0, color: (1, 1, 1), opacity: 0), (at: 1, color: (1, 1, 1), opacity: 0),";
    for (points, seen) in [(peaks.as_str(), true), (clear, false)] {
        for slots in [
            r#""classify": "post", "light": "phong""#,
            r#""classify": "preintegrated_2d", "light": "phong""#,
            r#""classify": "preintegrated_3d", "light": "phong""#,
            r#""classify": "integral_1d", "light": "phong_ends""#,
            r#""classify": "gauss2", "light": "phong""#,
            r#""classify": "preintegrated_2d", "light": "phong", "shadow": "transmittance""#,
        ] {
            let stage = sheets()
                .with("t.ron", format!("(points: [{points}])"))
                .with("graph.ron", graph_of(camera, slots));
            for backend in adapters() {
                let of = |traverse: &str| {
                    let traverse = format!("image.slots.traverse={traverse}");
                    render(&stage, &[&traverse], &backend, [64, 48]).0
                };
                let [plain, leapt] = ["uniform", "skip"].map(of);
                let light = plain.color.iter().map(|it| it[0]).fold(0.0, f32::max);
                assert_eq!(light > 0.01, seen, "{slots} on {backend}: {light}");
                let error = compare_without_flip(&plain, &leapt).unwrap().max.error;
                assert!(error <= 1e-6, "{slots} on {backend}: {error:e}");
            }
        }
    }
}

/// Spans alone spare the samples of what is empty.
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

/// Where all scalars absorb there is nothing to leap over, and nothing looks for it; until an edit makes some of them clear.
#[test]
fn what_absorbs_everywhere_is_walked_plainly() {
    let open = "(points: [(at: 0.1, color: (1, 0.5, 0), opacity: 0), (at: 1, color: (0, 0.5, 1), opacity: 0.4)])";
    let full = open.replace("opacity: 0)", "opacity: 0.01)");
    let stage = sheets().with("t.ron", &full);
    let graph = stage.path().join("graph.ron");
    for backend in adapters() {
        let session = |traverse: &str| {
            let set = format!("image.slots.traverse={traverse}");
            start(load(&graph, &[&set]).unwrap(), &backend, [48, 32]).unwrap()
        };
        stage.write("t.ron", &full);
        let mut skipping = session("skip");
        for (text, has_scout) in [(full.as_str(), false), (open, true), (full.as_str(), false)] {
            stage.write("t.ron", text);
            let changed = Change::Files(BTreeSet::from([stage.path().join("t.ron")]));
            let outcome = skipping.apply(&changed);
            assert!(
                matches!(outcome, Ok(Outcome::Drawn(_) | Outcome::Unchanged)),
                "{backend}"
            );
            let nodes = &skipping.plan().graph.nodes;
            let scouts = nodes.iter().filter(|node| node.name.ends_with(".scout"));
            assert_eq!(scouts.count(), usize::from(has_scout), "{backend}");
            let plain = session("uniform").render().unwrap().0;
            let leapt = skipping.render().unwrap().0;
            let error = compare_without_flip(&plain, &leapt).unwrap().max.error;
            assert!(error <= 1e-6, "{text} on {backend}: {error:e}");
        }
    }
}
