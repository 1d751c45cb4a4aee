//! Pre-integrated tables as pictures show them: of all lengths, and made by the graphics processor.

use std::path::Path;

use volgraph_measure::compare_without_flip;
use volgraph_optics::TransferFunction;
use volgraph_tests::slabs::{middles, slabs};
use volgraph_tests::{STAGES, Stage, adapters, graph, render};

const SMOOTH: &str = r##"(domain: data(from: 0, to: 1), color: [(0.0, "#1a2699"), (0.4, (1, 0.2, 0)), (1.0, (0, 1, 0.5))],
    opacity: [(0.1, 0.0), (0.6, 0.5), (1.0, 0.9)])"##;
const NARROW_PEAK: &str =
    "(domain: data(from: 0, to: 1), color: [(0.29, (1, 0, 0)), (0.31, (0, 0, 1))],
    opacity: [(0.299, 0.0), (0.3, 0.98), (0.301, 0.0)])";
const STEPS: &str = "(domain: data(from: 0, to: 1), color: [(0.0, (1, 0, 0)), (0.3, (1, 0, 0)), (0.3, (0, 0, 1)), (0.8, (0, 1, 1))],
    opacity: [(0.2, 0.0), (0.2, 0.3), (0.3, 0.3), (0.3, 0.95), (0.7, 0.1), (0.7, 0.6)])";
const OPAQUE: &str = "(domain: data(from: 0, to: 1), color: [(0.3, (1, 0, 0)), (0.301, (0, 1, 0)), (0.5, (0, 0, 1)), (0.52, (1, 1, 1))],
    opacity: [(0.3001, 0.0), (0.3006, 1.0), (0.4, 1.0), (0.4, 0.0), (0.5, 0.0), (0.5, 1.0), (0.7, 0.2)])";
const EVEN: &str = "(domain: data(from: 0, to: 1), color: (1, 0.5, 0.2), extinction: [(0.0, 3.0)])";

/// A view along x of a volume whose scalar depends on x alone: all rays are as long as the box, and alike.
fn stage(voxels: u32, scalar: impl Fn(f64) -> f64, transfer: &str) -> Stage {
    let last = f64::from(voxels - 1);
    let camera = "look_at(eye: (-20, 1, 1), target: (0, 1, 1), up: (0, 0, 1), projection: orthographic, height: 1)";
    let volume = format!(r#"path: "v_{voxels}x3x3_float32.raw", node_centred: true"#);
    let params = r#"{ "early_termination": 0.0 }"#;
    Stage::new()
        .with_floats("v", [voxels, 3, 3], |x, _, _| {
            scalar(f64::from(x) / last) as f32
        })
        .with("transfer.ron", transfer)
        .with("graph.ron", graph(&volume, camera, "{}", "{}", params))
}

/// Every backend with every stage.
fn everywhere() -> Vec<(String, &'static str)> {
    let backends = adapters().into_iter();
    let both = backends.flat_map(|backend| STAGES.map(|form| (backend.clone(), form)));
    both.collect()
}

/// Colour and opacity of the middle pixel.
fn seen(stage: &Stage, backend: &str, form: &str, sets: &[&str]) -> [f64; 4] {
    let form = format!("image.stage={form}");
    let sets: Vec<&str> = [form.as_str()].iter().chain(sets).copied().collect();
    let (picture, _) = render(stage, &sets, backend, [4, 4]);
    let opacity = f64::from(picture.opacity.as_ref().unwrap()[10]);
    let [r, g, b, _] = picture.color[10].map(f64::from);
    [r, g, b, opacity]
}

/// The same in float64: slabs between the scalars of voxels that lie one apart, thinner than anything here changes.
fn truth(transfer: &str, scalars: &[f64]) -> [f64; 4] {
    let parts = 400_000 / scalars.len() as u32;
    let transfer = TransferFunction::parse(Path::new("transfer.ron"), transfer).unwrap();
    let references = transfer.reference_length().extinction_per_world(1.0) / f64::from(parts);
    slabs(scalars.windows(2).flat_map(|pair| {
        let transfer = &transfer;
        middles(parts).map(move |share| {
            let scalar = pair[0] + share * (pair[1] - pair[0]);
            (
                transfer.color(scalar),
                transfer.extinction(scalar) * references,
            )
        })
    }))
}

fn samples(voxels: u32, scalar: impl Fn(f64) -> f64) -> Vec<f64> {
    let last = f64::from(voxels - 1);
    // As the volume holds them.
    let at = |x| f64::from(scalar(f64::from(x) / last) as f32);
    (0..voxels).map(at).collect()
}

fn error(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

const THREE_D: &str = "image.slots.classify=preintegrated_3d";
const TWO_D: &str = "image.slots.classify=preintegrated_2d";

#[test]
fn one_scalar_is_exact_at_any_step_with_any_last_segment() {
    // Eight voxels: last segments of a tenth of a step, of 5e-4 of one, of none, and of nearly a whole one. What is left
    // is float32's: of the box's ends (1e-6 voxels at this distance) and of some twenty factors.
    const BOUND: f64 = 2e-6;
    let transfer = "(domain: data(from: 0, to: 1), color: (1, 0.5, 0.2), extinction: [(0.0, 0.3)])";
    let stage = stage(9, |_| 0.5, transfer);
    let truth = truth(transfer, &samples(9, |_| 0.5));
    for (backend, form) in everywhere() {
        for step in ["7.9", "7.996", "2.7", "0.37"] {
            let step = format!("image.step={step}");
            let seen = seen(&stage, &backend, form, &[THREE_D, &step]);
            let error = error(seen, truth);
            println!("{backend} {form} {step}: {error:.1e}");
            assert!(error < BOUND, "{backend} {form} {step}: {seen:?}");
        }
    }
}

#[test]
fn a_ramp_is_exact_at_any_step_with_any_last_segment() {
    // Scalars are linear in segments, so that there is no error of the method. Of the table there is: between layers, for
    // a last segment of a part, at most 2.3e-4 where a reference length is crossed from 0 to 1 (see the table's own
    // tests); here last segments cross less than a sixth of that. Between entries, of which ramps begin there: 1e-5.
    const BOUND: f64 = 5e-5;
    let ramp = |x: f64| x;
    let transfer = SMOOTH.replacen('(', "(reference_length: (voxels: 6), ", 1);
    let stage = stage(9, ramp, &transfer);
    let truth = truth(&transfer, &samples(9, ramp));
    for (backend, form) in everywhere() {
        let error = |classify: &str, step: &str| {
            let step = format!("image.step={step}");
            error(seen(&stage, &backend, form, &[classify, &step]), truth)
        };
        for step in ["8", "1", "3.9999", "0.83", "2.7"] {
            let error = error(THREE_D, step);
            println!("{backend} {form} step {step}: {error:.1e}");
            assert!(error < BOUND, "{backend} {form} step {step}: {error:e}");
        }
        // The check sees a last segment that is taken as a part of a whole one.
        let of_part = error(TWO_D, "5.3");
        let of_length = error(THREE_D, "5.3");
        println!("{backend} {form}: 2D {of_part:.1e}, 3D {of_length:.1e}");
        assert!(of_length < BOUND && of_part > 20.0 * BOUND);
    }
}

#[test]
fn a_table_made_for_longer_segments_is_right_for_the_step() {
    let ramp = |x: f64| x;
    let stage = stage(9, ramp, SMOOTH);
    let truth = truth(SMOOTH, &samples(9, ramp));
    for backend in adapters() {
        let error = |sets: &[&str]| {
            let sets: Vec<&str> = [THREE_D].iter().chain(sets).copied().collect();
            error(seen(&stage, &backend, "compute", &sets), truth)
        };
        let coarse = error(&["image.preintegration_3d_longest=16"]);
        let layers = [
            "image.preintegration_3d_longest=16",
            "image.preintegration_3d_layers=29",
        ];
        let fine = error(&layers);
        println!("{backend}: 8 layers {coarse:.1e}, 29 layers {fine:.1e}");
        // Four times as many intervals, a sixteenth of the error.
        assert!(coarse < 5e-3 && fine < 5e-4, "{coarse:e} {fine:e}");
        // Entries that are few are seen.
        let few = error(&["image.preintegration_3d_size=64", "image.step=0.25"]);
        assert!(few > 2e-5, "{few:e}");
    }
}

#[test]
fn a_narrow_peak_is_met_by_segments_of_32_voxels() {
    // Ends of segments lie half-way between entries. The peak is 0.13 voxels wide and half an entry; far from the table's
    // diagonal it moves through a cell's segments in proportion, so that a second difference is below (1 / (n d))² of
    // the opacity, n d > 100 entries from end to end.
    const BOUND: f64 = 1e-4;
    let ramp = |x: f64| x;
    let stage = stage(65, ramp, NARROW_PEAK);
    let truth = truth(NARROW_PEAK, &samples(65, ramp));
    assert!(truth[3] > 0.1);
    for (backend, form) in everywhere() {
        for step in ["image.step=32", "image.step=24"] {
            for classify in [TWO_D, THREE_D] {
                let seen = seen(&stage, &backend, form, &[classify, step]);
                let error = error(seen, truth);
                println!("{backend} {classify} {step}: {error:.1e}");
                assert!(error < BOUND, "{backend} {classify} {step}: {seen:?}");
                for channel in &seen[..3] {
                    assert!(
                        *channel <= seen[3] + 1e-6,
                        "more colour than opacity: {seen:?}"
                    );
                }
            }
        }
        let post = ["image.slots.classify=post", "image.step=32"];
        let post = seen(&stage, &backend, form, &post);
        assert!(
            error(post, truth) > 0.1,
            "samples alone must miss it: {post:?}"
        );
    }
}

#[test]
fn a_table_that_ends_within_the_data_holds_its_ends() {
    // The transfer function's own values span a fiftieth of the data; segments of eight voxels enter and leave its table.
    let ramp = |x: f64| 1.0 - x;
    let transfer = NARROW_PEAK
        .replace("data(from: 0, to: 1)", "data")
        .replace("(0.299, 0.0)", "(0.299, 0.05)")
        .replace("(0.301, 0.0)", "(0.301, 0.02)");
    let stage = stage(65, ramp, &transfer);
    let truth = truth(&transfer, &samples(65, ramp));
    for (backend, form) in everywhere() {
        // The 2D table takes the part within as a part of a whole segment.
        for (classify, bound) in [(THREE_D, 1e-4), (TWO_D, 5e-3)] {
            let seen = seen(&stage, &backend, form, &[classify, "image.step=8"]);
            let error = error(seen, truth);
            println!("{backend} {classify}: {error:.1e}");
            assert!(
                error < bound,
                "{backend} {classify}: {seen:?}, not {truth:?}"
            );
        }
    }
}

#[test]
fn far_beyond_a_table_its_ends_hold() {
    // Texture coordinates of so many tables beyond the last entry do not fit in 32 bits of a table's texels. The picture is
    // that of one scalar: exact but for float32's roundings, of the volume's samples as well.
    const BOUND: f64 = 4e-6;
    let transfer = "(domain: data(from: 0, to: 1), color: [(0, (1, 0, 0.2)), (1, (0, 1, 0.4))],
        extinction: [(0, 0.05), (1, 0.3)])";
    for scalar in [1e7, -1e7, 1e20] {
        let stage = stage(9, |x| scalar * (0.9 + 0.1 * x), transfer);
        let truth = truth(transfer, &samples(9, |_| scalar));
        for (backend, form) in adapters().iter().zip(STAGES) {
            for classify in [
                "post",
                "gauss2",
                "simpson",
                "integral_1d",
                "preintegrated_2d",
            ] {
                let classify = format!("image.slots.classify={classify}");
                let seen = seen(&stage, backend, form, &[&classify]);
                let error = error(seen, truth);
                println!("{backend} {form} {classify} {scalar:e}: {error:.1e}");
                assert!(
                    error < BOUND,
                    "{backend} {form} {classify} {scalar:e}: {seen:?} {truth:?}"
                );
            }
        }
    }
}

#[test]
fn below_a_step_at_the_start_is_what_is_before_it() {
    // Nothing below 0.4, and dense from there on. At a step of 0.02 voxels a rule of points misplaces the step by half of
    // one, and a table by an entry (8e-3 voxels): less than 0.01 voxels of an extinction of 0.7. Were the first entry of
    // tables the later value, all that is below would be as dense, and the picture 0.04 to 0.9 off.
    const BOUND: f64 = 1e-2;
    let transfer =
        "(domain: data, color: (1, 0.5, 0.2), opacity: [(0.4, 0), (0.4, 0.5), (0.8, 0.1)])";
    let falling = |x: f64| 0.45 - 0.45 * x;
    let stage = stage(9, falling, transfer);
    let truth = truth(transfer, &samples(9, falling));
    for (backend, form) in adapters().iter().zip(STAGES) {
        for classify in [
            "post",
            "simpson",
            "integral_1d",
            "preintegrated_2d",
            "preintegrated_3d",
        ] {
            let classify = format!("image.slots.classify={classify}");
            let seen = seen(&stage, backend, form, &[&classify, "image.step=0.02"]);
            let error = error(seen, truth);
            println!("{backend} {form} {classify}: {error:.1e}");
            assert!(
                error < BOUND,
                "{backend} {form} {classify}: {seen:?} {truth:?}"
            );
        }
    }
}

#[test]
fn at_whole_segments_both_tables_say_the_same() {
    // With as many entries they differ in what is linear between them alone: mean colour, or premultiplied colour.
    // Across a step either is off by as much as the part of an entry shows where the step lies: of segments of eight
    // voxels, of 120 entries each, by a hundredth.
    let ramp = |x: f64| 0.97 * x;
    for (transfer, step, bound) in [
        (SMOOTH, "image.step=1", 1e-5),
        (STEPS, "image.step=8", 1e-4),
        (OPAQUE, "image.step=8", 1e-4),
    ] {
        let stage = stage(33, ramp, transfer);
        for (backend, form) in everywhere() {
            let [flat, deep] = [TWO_D, THREE_D].map(|classify| {
                let sets = [classify, step, "image.preintegration_size=512"];
                seen(&stage, &backend, form, &sets)
            });
            let error = error(flat, deep);
            println!("{backend} {step}: {error:.1e}");
            assert!(
                error < bound,
                "{backend} {step}: {flat:?} {deep:?} of {transfer}"
            );
            for channel in &deep[..3] {
                assert!(
                    *channel <= deep[3] + 1e-6,
                    "more colour than opacity: {deep:?}"
                );
            }
        }
    }
}

#[test]
fn the_order_in_the_step_is_two() {
    // A scalar that bends: within a segment it is taken as linear. Steps are whole voxels, so that the field's own bends
    // lie at ends of segments; the last segment is of any length.
    let wave = |x: f64| 0.55 + 0.4 * (5.0 * x).sin();
    // One reference length is 32 voxels: mild, so that the error is the quadrature's.
    let transfer = SMOOTH.replacen('(', "(reference_length: (voxels: 32), ", 1);
    let stage = stage(130, wave, &transfer);
    let truth = truth(&transfer, &samples(130, wave));
    for backend in adapters() {
        let errors = ["image.step=16", "image.step=8", "image.step=4"]
            .map(|step| error(seen(&stage, &backend, "compute", &[THREE_D, step]), truth));
        let orders: Vec<f64> = errors
            .windows(2)
            .map(|pair| (pair[0] / pair[1]).log2())
            .collect();
        println!("{backend}: {errors:?}, orders {orders:.2?}");
        assert!(
            orders.iter().all(|order| (1.6..2.4).contains(order)),
            "{errors:?}"
        );
    }
}

/// Two nodes make the same table, on the processor and on the graphics processor.
fn both_tables(transfer: &str, size: u32, step: &str) -> Stage {
    let table = |on: &str| {
        format!(
            r#"(kind: "preintegration", in: {{ "transfer": "t", "volume": "v" }},
                params: {{ "preintegration_size": {size}, "step": {step}, "preintegration_built_on": "{on}" }})"#
        )
    };
    let text = format!(
        r#"(sources: {{ "v": volume(path: "v_4x4x4_float32.raw"), "t": transfer(path: "t.ron") }},
            nodes: {{ "background": (kind: "background"), "cpu": {}, "gpu": {} }},
            outputs: {{ "color": "background.color", "of_cpu": "cpu.table", "of_gpu": "gpu.table" }})"#,
        table("cpu"),
        table("gpu")
    );
    Stage::new()
        .with_floats("v", [4, 4, 4], |x, _, _| x as f32)
        .with("t.ron", transfer)
        .with("graph.ron", text)
}

#[test]
fn a_table_of_the_graphics_processor_is_that_of_the_processor() {
    // Float32 with a rounding or two for each of the cells: a thousand cells, and roundings of 6e-8 of both signs.
    const BOUND: f64 = 1e-5;
    for (name, transfer, size, step) in [
        ("smooth", SMOOTH, 512, "1"),
        ("even", EVEN, 1000, "1"),
        ("smooth", SMOOTH, 200, "0.25"),
        ("narrow peak", NARROW_PEAK, 301, "8"),
        ("steps", STEPS, 256, "32"),
        ("opaque", OPAQUE, 300, "1"),
        ("opaque", OPAQUE, 77, "32"),
    ] {
        let stage = both_tables(transfer, size, step);
        for backend in adapters() {
            let mut session = stage.open("graph.ron", &[], &backend, [4, 4]).unwrap();
            session.draw().unwrap();
            let [cpu, gpu] = ["of_cpu", "of_gpu"].map(|output| session.read(output).unwrap().color);
            assert_eq!(cpu.len(), (size * size) as usize);
            let (mut worst, mut worst_depth, mut most) = (0.0_f64, 0.0_f64, 0.0_f32);
            for (cpu, gpu) in cpu.iter().zip(&gpu) {
                for i in 0..3 {
                    worst = worst.max(f64::from(cpu[i] - gpu[i]).abs());
                    most = most.max(cpu[i]);
                }
                let depth = f64::from(cpu[3] - gpu[3]).abs() / f64::from(cpu[3]).max(1.0);
                worst_depth = worst_depth.max(depth);
            }
            println!(
                "{backend}, {name}, {size}, step {step}: colour {worst:.1e}, depth {worst_depth:.1e}"
            );
            assert!(
                worst < BOUND,
                "{backend}, {name}, {size}, step {step}: {worst:e}"
            );
            assert!(
                worst_depth < BOUND,
                "{backend}, {name}, {size}, step {step}: {worst_depth:e}"
            );
            assert!(most > 0.1, "{name} shows nothing");
        }
    }
}

#[test]
fn tables_that_do_not_fit_are_refused_with_a_size_that_does() {
    let stage = stage(9, |x| x, SMOOTH);
    let backend = &adapters()[0];
    let sets = [
        THREE_D,
        "image.preintegration_3d_size=2048",
        "image.preintegration_3d_layers=64",
    ];
    let refused = stage
        .open("graph.ron", &sets, backend, [4, 4])
        .err()
        .unwrap();
    let text = refused.to_string();
    assert!(
        refused
            .into_iter()
            .any(|finding| finding.code == "over-limit"),
        "{text}"
    );
    assert!(
        text.contains("set `preintegration_3d_size` to 1024 or less"),
        "{text}"
    );
}

/// Of segments that let no light through, parts may: the nearest entry of a table has transmittances, and still tells how
/// deep they are.
#[test]
fn the_nearest_entry_knows_great_depths() {
    for extinction in ["0.3", "30", "90", "5000", "1000000"] {
        let stage = Stage::new()
            .with_floats("v", [8; 3], |_, _, _| 0.5)
            .with(
                "t.ron",
                format!("(domain: data, color: [(0, (1, 0.5, 0.25)), (1, (1, 0.5, 0.25))], extinction: [(0, {extinction}), (1, {extinction})])"),
            )
            .with(
                "graph.ron",
                r#"(sources: { "v": volume(path: "v_8x8x8_float32.raw"), "t": transfer(path: "t.ron") },
                    camera: orbit(azimuth: 33, elevation: 21),
                    nodes: {
                        "box":   (kind: "proxy_box", in: { "volume": "v" }),
                        "image": (kind: "raycast", in: { "volume": "v", "transfer": "t", "rays": "box" },
                                  slots: { "classify": "preintegrated_2d" }, params: { "early_termination": 0 }),
                    },
                    outputs: { "color": "image.color" })"#,
            );
        for backend in adapters() {
            for set in [
                "image.step=1",
                "image.slots.walk=segments",
                "image.preintegration_built_on=gpu",
            ] {
                let of = |lookup: &str| {
                    let lookup = format!("image.lookup={lookup}");
                    render(&stage, &[&lookup, set], &backend, [96, 80]).0
                };
                let [between, nearest] = ["bilinear", "nearest"].map(of);
                let error = compare_without_flip(&between, &nearest).unwrap().max.error;
                assert!(error <= 1e-5, "{extinction} on {backend}, {set}: {error:e}");
            }
        }
    }
}

/// What the fourth number of an entry is goes with the lookup, so a table of the user's own has to fit.
#[test]
fn a_table_for_the_other_lookup_is_refused() {
    let backend = &adapters()[0];
    for (kind, rays) in [("raycast", r#""rays": "box","#), ("slices", "")] {
        let stage = Stage::new()
            .with_floats("v", [4; 3], |x, _, _| x as f32)
            .with("t.ron", SMOOTH)
            .with(
                "graph.ron",
                format!(
                    r#"(sources: {{ "v": volume(path: "v_4x4x4_float32.raw"), "t": transfer(path: "t.ron") }},
                        nodes: {{
                            "box":   (kind: "proxy_box", in: {{ "volume": "v" }}),
                            "table": (kind: "preintegration", in: {{ "transfer": "t", "volume": "v" }}),
                            "image": (kind: "{kind}", in: {{ {rays} "volume": "v", "transfer": "t", "preintegration_table": "table" }},
                                      slots: {{ "classify": "preintegrated_2d" }}, params: {{ "lookup": "nearest" }}),
                        }},
                        outputs: {{ "color": "image.color" }})"#
                ),
            );
        let drawn = |sets: &[&str]| {
            let session = stage.open("graph.ron", sets, backend, [8, 8]);
            session.and_then(|mut session| session.render().map(|_| ()))
        };
        let findings = drawn(&[]).unwrap_err().to_string();
        assert!(
            findings.contains("is made for `bilinear`"),
            "{kind}: {findings}"
        );
        drawn(&["table.lookup=nearest"]).unwrap();
    }
}
