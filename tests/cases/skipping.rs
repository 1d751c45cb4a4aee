//! Leaps over what a technique does not see leave the picture as it is, and take what they promise: fewer samples.

use volgraph::{Change, Findings, Outcome, ParamOverride, Picture, Scene};
use volgraph_gpu::TexelValues;
use volgraph_measure::compare_without_flip;
use volgraph_tests::repository::{COMPARISONS, PARTS_AND_PROJECTIONS, SOLIDS, VOLUMES, graph_file};
use volgraph_tests::{Stage, adapters, load, start};

const SIZE: [u32; 2] = [49, 41];

fn sets(typed: &[&str]) -> Vec<ParamOverride> {
    let parse = |typed: &&str| ParamOverride::parse(typed).unwrap();
    typed.iter().map(parse).collect()
}

fn render(scene: &Scene, backend: &str, traverse: &str) -> Result<Picture, Findings> {
    let scene = scene.with_sets(&sets(&[&format!("image.slots.traverse={traverse}")]))?;
    Ok(start(scene, backend, SIZE)?.render()?.0)
}

/// The largest difference that leaps make.
fn difference(name: &str, scene: &Scene, backend: &str) -> f64 {
    let [plain, leapt] = ["uniform", "skip"].map(|traverse| {
        render(scene, backend, traverse)
            .unwrap_or_else(|findings| panic!("{name} on {backend}: {findings}"))
    });
    compare_without_flip(&plain, &leapt).unwrap().max.error
}

fn stay_the_same(names: &[&str]) {
    // These show how the walk went: its samples, and the estimate by pairs of segments, which starts anew behind a leap.
    let of_walks = ["adaptive", "samples", "error"];
    for name in names.iter().filter(|name| !of_walks.contains(name)) {
        let scene = load(&graph_file(name), &[]).unwrap_or_else(|findings| panic!("{findings}"));
        for backend in adapters() {
            let difference = difference(name, &scene, &backend);
            assert!(difference <= 1e-6, "{name} on {backend}: {difference:e}");
        }
    }
}

#[test]
fn solids_stay_the_same() {
    stay_the_same(SOLIDS);
}

#[test]
fn volumes_stay_the_same() {
    stay_the_same(VOLUMES);
}

#[test]
fn parts_and_projections_stay_the_same() {
    stay_the_same(PARTS_AND_PROJECTIONS);
}

#[test]
fn comparisons_stay_the_same() {
    stay_the_same(COMPARISONS);
}

/// Numbers that look like chance, from 0 to 1.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.next() * choices.len() as f64) as usize]
    }
}

/// Blobs in what is empty but for a little noise below where anything absorbs.
fn blobs(chance: &mut Chance, dims: [u32; 3]) -> impl Fn(u32, u32, u32) -> f32 + use<> {
    let longest = f64::from(*dims.iter().max().unwrap());
    let blobs: Vec<([f64; 3], f64)> = (0..3)
        .map(|_| {
            let centre = dims.map(|n| chance.next() * f64::from(n));
            (centre, (0.05 + 0.15 * chance.next()) * longest)
        })
        .collect();
    move |x, y, z| {
        let place = [x, y, z].map(f64::from);
        let near = blobs.iter().map(|(centre, radius)| {
            let square: f64 = (0..3).map(|i| (place[i] - centre[i]).powi(2)).sum();
            (1.0 - square.sqrt() / radius).max(0.0)
        });
        let noise = 0.01 * f64::from((x * 7 + y * 13 + z * 29) % 11);
        (near.fold(0.0, f64::max) + noise) as f32
    }
}

#[test]
fn whatever_there_is_to_skip_the_picture_is_that_of_the_plain_walk() {
    let mut chance = Chance(5);
    for number in 0..24 {
        let dims = [0; 3].map(|_| chance.of(&[1_u32, 2, 7, 20, 33]));
        let [x, y, z] = dims;
        let technique = chance.of(&[
            "dvr",
            "isosurface",
            "mip",
            "minip",
            "isosurface_dvr",
            "isosurfaces_translucent",
        ]);
        let step = 0.3 + 3.0 * chance.next().powi(2);
        let camera = format!(
            "orbit(azimuth: {}, elevation: {}, zoom: {})",
            360.0 * chance.next(),
            160.0 * chance.next() - 80.0,
            chance.of(&[0.7, 1.0, 3.0, 30.0])
        );
        let transfer = chance.of(&[
            "(points: [(at: 0.2, color: (1, 0.5, 0), opacity: 0), (at: 1, color: (0, 0.5, 1), opacity: 0.9)])",
            "(points: [(at: 0.3, color: (1, 1, 0), opacity: 0), (at: 0.3, color: (1, 0, 0), opacity: 0.7), (at: 0.5, color: (1, 0, 0), opacity: 0.7), (at: 0.5, color: (0, 0, 1), opacity: 0)])",
            "(points: [(at: 0, color: (1, 0.5, 0), opacity: 0), (at: 1, color: (0, 0.5, 1), opacity: 0.5)])",
        ]);
        let classify = chance.of(&["post", "preintegrated_2d", "gauss2"]);
        let (brick, node_centred) = (chance.of(&[2, 3, 8, 16]), chance.of(&["true", "false"]));
        let stage = Stage::new()
            .with_floats("v", dims, blobs(&mut chance, dims))
            .with("transfer.ron", transfer)
            .with(
                "graph.ron",
                format!(
                    r#"(
    sources: {{
        "v": volume(path: "v_{x}x{y}x{z}_float32.raw", spacing: (1, 1.5, 0.7), node_centred: {node_centred}),
        "t": transfer(path: "transfer.ron"),
    }},
    camera: {camera},
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "box" }},
                  slots: {{ "technique": "{technique}", "classify": "{classify}" }},
                  params: {{ "step": {step}, "brick_size": {brick} }}),
    }},
    outputs: {{ "color": "image.color", "samples": "image.samples" }},
)"#
                ),
            );
        let scene = load(&stage.path().join("graph.ron"), &[])
            .unwrap_or_else(|findings| panic!("{number}: {findings}"));
        let backends = adapters();
        let backend = &backends[number % backends.len()];
        let case = format!("{number}: {technique} {classify} of {dims:?}, {camera}");
        let difference = difference(&case, &scene, backend);
        assert!(difference <= 1e-6, "{case} on {backend}: {difference:e}");
    }
}

/// Grids of light are what they are without leaps: matter, isosurfaces beside it, parts cut off, steps of all lengths.
#[test]
fn what_rays_towards_lights_leap_over_takes_none_of_them() {
    let mut chance = Chance(11);
    let mut shadows = 0;
    for number in 0..12 {
        let dims = [0; 3].map(|_| chance.of(&[7_u32, 20, 33]));
        let [x, y, z] = dims;
        let technique = chance.of(&["dvr", "dvr", "isosurface_dvr"]);
        let traverse = chance.of(&["skip", "adaptive"]);
        let clip = chance.of(&["none", "sphere"]);
        let classify = chance.of(&["post", "preintegrated_2d"]);
        let shadow_step = 0.2 + 2.0 * chance.next().powi(2);
        let brick = chance.of(&[1, 2, 3, 8]);
        let transfer = chance.of(&[
            "(points: [(at: 0.2, color: (1, 0.5, 0), opacity: 0), (at: 1, color: (0, 0.5, 1), opacity: 0.5)])",
            "(points: [(at: 0.3, color: (1, 1, 0), opacity: 0), (at: 0.3, color: (1, 0, 0), opacity: 0.7)])",
        ]);
        let stage = Stage::new()
            .with_floats("v", dims, blobs(&mut chance, dims))
            .with("transfer.ron", transfer)
            .with(
                "graph.ron",
                format!(
                    r#"(
    sources: {{
        "v": volume(path: "v_{x}x{y}x{z}_float32.raw", spacing: (1, 1.5, 0.7)),
        "t": transfer(path: "transfer.ron"),
    }},
    camera: orbit(azimuth: 20, elevation: 30),
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "box" }},
                  slots: {{ "technique": "{technique}", "classify": "{classify}", "traverse": "{traverse}",
                           "light": "phong", "shadow": "light_volume", "clip": "{clip}" }},
                  params: {{ "shadow_step": {shadow_step}, "brick_size": {brick}, "light_resolution": 24, "lights": 2,
                            "light_1": [0.3, -0.8, 1.0, 0.0], "light_2": [2.0, 1.0, -3.0, 1.0] }}),
    }},
    outputs: {{ "color": "image.color", "light": "image.light_volume.light" }},
)"#
                ),
            );
        let scene = load(&stage.path().join("graph.ron"), &[]).unwrap();
        let backends = adapters();
        let backend = &backends[number % backends.len()];
        let [leapt, plain] = [traverse, "uniform"].map(|traverse| {
            let sets = sets(&[&format!("image.slots.traverse={traverse}")]);
            let mut session = start(scene.with_sets(&sets).unwrap(), backend, SIZE).unwrap();
            session.draw().unwrap();
            let leaps = session.plan().graph.nodes.iter().any(|node| {
                let program = node.program.as_ref();
                let used = program.and_then(|it| it.module.linked.slots_used.get("shadow_leap"));
                used.is_some_and(|file| file.ends_with("bricks.wgsl"))
            });
            let is_by_matter_alone = technique == "dvr";
            assert_eq!(
                leaps,
                traverse != "uniform" && is_by_matter_alone,
                "{number}: {traverse}"
            );
            let TexelValues::Bytes(light) = session.texels("light").unwrap().values else {
                panic!("{number}: a grid of half floats");
            };
            light
        });
        let case = format!("{number}: {technique} {classify} {traverse} {clip} of {dims:?}");
        assert!(leapt == plain, "{case} on {backend}");
        // Half floats that are not negative rise with their bits.
        let shares = plain.chunks_exact(2);
        let mut shares = shares.map(|share| u16::from_le_bytes([share[0], share[1]]));
        shadows += usize::from(shares.any(|share| share < 0x3b00));
    }
    assert!(shadows >= 8, "{shadows} of 12 have shadows");
}

/// A ball in the middle of 64³, of a quarter of the box.
fn ball(transfer: &str, slots: &str) -> Stage {
    let field = |x: u32, y: u32, z: u32| {
        let square: f64 = [x, y, z]
            .map(|i| (f64::from(i) - 31.5).powi(2))
            .iter()
            .sum();
        (1.0 - square.sqrt() / 16.0).max(0.0) as f32
    };
    Stage::new()
        .with_floats("v", [64; 3], field)
        .with("transfer.ron", transfer)
        .with(
            "graph.ron",
            format!(
                r#"(
    sources: {{ "v": volume(path: "v_64x64x64_float32.raw"), "t": transfer(path: "transfer.ron") }},
    camera: orbit(azimuth: 20, elevation: 30),
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "box" }}, slots: {{ {slots} }}),
    }},
    outputs: {{ "color": "image.color", "samples": "image.samples" }},
)"#
            ),
        )
}

const RAMP: &str =
    "(points: [(at: 0, color: (1, 1, 1), opacity: 0), (at: 1, color: (1, 1, 1), opacity: 0.1)])";

#[test]
fn leaps_take_a_fraction_of_the_samples() {
    for (slots, size, least) in [
        // The ball fills less than a fifth of what the rays see of the box. Spans are those of a tile of pixels, which has to
        // be much narrower than the ball: in smaller pictures walking costs less than looking closer would.
        (r#""technique": "dvr""#, [98, 82], 2.5),
        (r#""technique": "isosurface""#, SIZE, 2.0),
    ] {
        let stage = ball(RAMP, slots);
        let scene = load(&stage.path().join("graph.ron"), &[]).unwrap();
        for backend in adapters() {
            let [plain, leapt] = ["uniform", "skip"].map(|traverse| {
                let sets = sets(&[&format!("image.slots.traverse={traverse}")]);
                let mut session = start(scene.with_sets(&sets).unwrap(), &backend, size).unwrap();
                session.draw().unwrap();
                let samples = session.read("samples").unwrap();
                samples.color.iter().map(|it| f64::from(it[0])).sum::<f64>()
            });
            let gain = plain / leapt;
            assert!(gain > least, "{slots} on {backend}: {plain} to {leapt}");
        }
    }
}

#[test]
fn what_an_edit_reveals_is_seen_and_the_map_is_made_again_for_that_alone() {
    let at = |at: f64, color: &str| {
        format!(
            "(points: [(at: {at}, color: ({color}), opacity: 0), (at: 1, color: ({color}), opacity: 0.5)])"
        )
    };
    let slots = r#""classify": "preintegrated_2d", "traverse": "skip""#;
    let stage = ball(&at(0.8, "1, 1, 1"), slots);
    for backend in adapters() {
        stage.write("transfer.ron", at(0.8, "1, 1, 1"));
        let mut session = stage.open("graph.ron", &[], &backend, SIZE).unwrap();
        let first = session.draw().unwrap();
        assert!(
            first.ran().contains(&"image.scout.distance_map"),
            "{:?}",
            first.ran()
        );
        let mut edit = |text: String| {
            stage.write("transfer.ron", text);
            let path = stage.path().join("transfer.ron");
            match session.apply(&Change::Files([path].into())) {
                Ok(Outcome::Drawn(drawn)) => {
                    let ran = drawn.report.frame.ran();
                    (
                        drawn.picture.clone(),
                        ran.contains(&"image.scout.distance_map"),
                    )
                }
                other => panic!("{other:?}"),
            }
        };
        let (_, is_made_again) = edit(at(0.8, "1, 0, 0"));
        assert!(
            !is_made_again,
            "{backend}: another colour is seen in the same places"
        );
        let (revealed, is_made_again) = edit(at(0.1, "1, 0, 0"));
        assert!(is_made_again, "{backend}");
        let fresh = stage.open(
            "graph.ron",
            &["image.slots.traverse=uniform"],
            &backend,
            SIZE,
        );
        let fresh = fresh.unwrap().render().unwrap().0;
        let difference = compare_without_flip(&revealed, &fresh).unwrap().max.error;
        assert!(difference <= 1e-6, "{backend}: {difference:e}");
    }
}

/// A walk of a user's own whose segments grow, so that their number says nothing of where they are.
const GROWING: &str = "// Where does the next segment end?
#import \"lib/step.wgsl\"

fn traverse_segment_end(ray: Ray, index: u32) -> f32 {
    let even = f32(index + 1u);
    return min(even * (1.0 + 0.05 * even) * step_world(), ray.far - ray.near);
}
";

#[test]
fn a_walk_that_does_not_count_in_whole_steps_never_leaps() {
    let stage = ball(RAMP, r#""traverse": "growing""#).with("slot/traverse/growing.wgsl", GROWING);
    for backend in adapters() {
        let [own, all] = [&[][..], &["image.slots.emptiness=none"]].map(|sets| {
            let session = stage.open("graph.ron", sets, &backend, SIZE);
            session.unwrap().render().unwrap().0
        });
        let difference = compare_without_flip(&own, &all).unwrap().max.error;
        assert!(difference == 0.0, "{backend}: {difference:e}");
        assert!(own.color.iter().any(|color| color[3] > 0.1), "{backend}");
    }
}

#[test]
fn raycasts_that_skip_share_their_map_whatever_else_differs() {
    let stage = ball(RAMP, "");
    let two = r#"(
    sources: { "v": volume(path: "v_64x64x64_float32.raw"), "t": transfer(path: "transfer.ron") },
    camera: orbit(azimuth: 20, elevation: 30),
    nodes: {
        "box": (kind: "proxy_box", in: { "volume": "v" }),
        "a":   (kind: "raycast", in: { "volume": "v", "transfer": "t", "rays": "box" },
                slots: { "traverse": "skip" }, params: { "step": 1.0 }),
        "b":   (kind: "raycast", in: { "volume": "v", "transfer": "t", "rays": "box" },
                slots: { "traverse": "skip" }, params: { "step": 0.5 }),
        "difference": (kind: "difference", in: { "a": "a.color", "b": "b.color" }),
    },
    outputs: { "color": "difference.color" },
)"#;
    stage.write("two.ron", two);
    for backend in adapters() {
        let mut session = stage.open("two.ron", &[], &backend, SIZE).unwrap();
        let report = session.draw().unwrap();
        let ran = report.ran();
        let maps = ran.iter().filter(|name| name.ends_with(".distance_map"));
        assert_eq!(maps.count(), 1, "{backend}: {ran:?}");
    }
}
