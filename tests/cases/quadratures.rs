//! The choices of the slot `classify`: the order that each declares, and what must hold at any step.

mod ramps;

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_measure::order;
use volgraph_optics::TransferFunction;
use volgraph_shader::order::{declared_orders, order_where};
use volgraph_tests::repository::choices;
use volgraph_tests::slabs::{middles, slabs};
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render, root};

/// Those for tests.
const FOR_TESTS: [&str; 2] = ["ends", "unattenuated"];

fn for_tests() -> [String; 2] {
    FOR_TESTS.map(str::to_owned)
}

fn file_of(choice: &str) -> std::path::PathBuf {
    let folder = if FOR_TESTS.contains(&choice) {
        "tests/shaders"
    } else {
        "shaders"
    };
    root().join(format!("{folder}/slot/classify/{choice}.wgsl"))
}

/// The order that a choice declares, with the defaults of its parameters.
pub fn declared(choice: &str) -> f64 {
    let text = std::fs::read_to_string(file_of(choice)).unwrap();
    let orders = declared_orders(&file_of(choice), &text).unwrap();
    let defaults = [("attenuation", "exact"), ("lookup", "bilinear")];
    order_where(&orders, |param| {
        let default = defaults.iter().find(|(name, _)| *name == param);
        default.map(|(_, choice)| (*choice).to_owned())
    })
    .unwrap()
}

/// The choices for tests lie in the graph's folder.
fn stage(volume: &str, camera: &str, transfer: &str, params: &str) -> Stage {
    let params = format!(r#"{{ "early_termination": 0.0, {params} }}"#);
    let mut stage = Stage::new().with("transfer.ron", transfer).with(
        "graph.ron",
        graph(volume, camera, "{}", r#"{ "classify": "post" }"#, &params),
    );
    for choice in FOR_TESTS {
        let text = std::fs::read(file_of(choice)).unwrap();
        stage = stage.with(&format!("slot/classify/{choice}.wgsl"), text);
    }
    stage
}

/// What one classification draws at one step.
fn draw(
    stage: &Stage,
    backend: &str,
    form: &str,
    choice: &str,
    step: f64,
    size: [u32; 2],
) -> (Picture, View) {
    // What a table of second order is interpolated by shows beside errors of order 4.
    let size_of_table = if choice == "second_order" { 2048 } else { 1024 };
    let sets = [
        format!("image.preintegration_size={size_of_table}"),
        format!("image.stage={form}"),
        format!("image.slots.classify={choice}"),
        format!("image.step={step:?}"),
    ];
    let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
    render(stage, &sets, backend, size)
}

/// Colour and opacity of each pixel, and whether its ray is longer than `least` in the box; and the truth of it.
fn pixels(
    (picture, view): &(Picture, View),
    (low, high): (DVec3, DVec3),
    least: f64,
    truth: impl Fn(DVec3, DVec3) -> [f64; 4],
) -> Vec<([f64; 4], [f64; 4])> {
    let opacity = picture.opacity.as_ref().unwrap();
    let mut found = Vec::new();
    for (at, ([r, g, b, _], opacity)) in picture.color.iter().zip(opacity).enumerate() {
        let pixel = u32::try_from(at).unwrap();
        let ray = ray(view, pixel % view.size[0], pixel / view.size[0]);
        let Some((near, far)) =
            box_interval(ray, low, high).filter(|(near, far)| far - near > least)
        else {
            continue;
        };
        let seen = [*r, *g, *b, *opacity].map(f64::from);
        found.push((seen, truth(ray.0 + ray.1 * near, ray.0 + ray.1 * far)));
    }
    assert!(found.len() > 50, "the volume fills {} pixels", found.len());
    found
}

fn shown(errors: &[f64]) -> String {
    let errors: Vec<String> = errors.iter().map(|error| format!("{error:.2e}")).collect();
    errors.join(" ")
}

fn worst(pixels: &[([f64; 4], [f64; 4])]) -> f64 {
    let errors = pixels.iter().flat_map(|(seen, truth)| {
        (0..4).map(move |channel| (seen[channel] - truth[channel]).abs())
    });
    errors.fold(0.0, f64::max)
}

fn rms(pixels: &[([f64; 4], [f64; 4])]) -> f64 {
    let squares = pixels.iter().flat_map(|(seen, truth)| {
        (0..4).map(move |channel| (seen[channel] - truth[channel]).powi(2))
    });
    (squares.sum::<f64>() / (4 * pixels.len()) as f64).sqrt()
}

/// The corners of the one cell of the smooth scenes, x fastest. They are f32, so that they are exact.
const CORNERS: [f32; 8] = [0.15, 0.7, 0.55, 0.25, 0.85, 0.4, 0.3, 0.95];

/// Extinction per voxel at the scalar 1.
const DENSITY: f64 = 6.0;

fn smooth_color(scalar: f64) -> [f64; 3] {
    [1.0 - 0.9 * scalar, 0.1 + 0.7 * scalar, scalar]
}

/// One trilinear cell: its scalar is a cubic along every ray. Extinction and colour are linear in it: the depth is a
/// polynomial, and the colour an integral by Simpson's rule, whose error is below 1e-10 with so many parts.
fn smooth_truth(from: DVec3, to: DVec3) -> [f64; 4] {
    const PARTS: u32 = 800;
    let field = |place: DVec3| {
        (0..8).fold(0.0, |sum, corner| {
            let weight = |side: u32, part: f64| if side == 1 { part } else { 1.0 - part };
            let weight = weight(corner & 1, place.x)
                * weight(corner >> 1 & 1, place.y)
                * weight(corner >> 2, place.z);
            sum + weight * f64::from(CORNERS[corner as usize])
        })
    };
    let [a, b, c, d] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|w| field(from.lerp(to, w)));
    let cubic = 4.5 * (d - 3.0 * c + 3.0 * b - a);
    let square = 4.5 * (a - 2.0 * b + c) - cubic;
    let line = d - a - cubic - square;
    let scalar = |w: f64| a + w * (line + w * (square + w * cubic));
    let length = from.distance(to);
    let depth = |w: f64| {
        DENSITY * length * w * (a + w * (line / 2.0 + w * (square / 3.0 + w * cubic / 4.0)))
    };
    let mut color = [0.0; 3];
    for at in 0..=PARTS {
        let w = f64::from(at) / f64::from(PARTS);
        let weight = match at {
            0 | PARTS => 1.0,
            at if at % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let emitted =
            weight / 3.0 / f64::from(PARTS) * DENSITY * length * scalar(w) * (-depth(w)).exp();
        for (sum, channel) in color.iter_mut().zip(smooth_color(scalar(w))) {
            *sum += channel * emitted;
        }
    }
    [color[0], color[1], color[2], 1.0 - (-depth(1.0)).exp()]
}

#[test]
fn each_choice_has_the_order_that_it_declares() {
    let mut bytes = Vec::new();
    for corner in CORNERS {
        bytes.extend(corner.to_le_bytes());
    }
    let transfer = format!(
        "(domain: data, color: [(0, (1, 0.1, 0)), (1, (0.1, 0.8, 1))], extinction: [(0, 0), (1, {DENSITY:?})])"
    );
    let scene = stage(
        r#"path: "v_2x2x2_float32.raw", node_centred: true"#,
        "orbit(azimuth: 33, elevation: 21, projection: orthographic)",
        &transfer,
        "",
    )
    .with("v_2x2x2_float32.raw", bytes);
    let span = (DVec3::ZERO, DVec3::ONE);
    for backend in adapters() {
        for choice in choices("classify").iter().chain(&for_tests()) {
            let theory = declared(choice);
            // Four halvings, of steps between those that are too long for the theory and those at which f32 is a floor:
            // with order 4 an error falls by 65,536, to 1e-7.
            let longest = if theory > 3.0 { 1.0 } else { 0.5 };
            let steps = [1.0, 0.5, 0.25, 0.125, 0.0625].map(|step| longest * step);
            let errors = steps.map(|step| {
                let drawn = draw(&scene, &backend, "compute", choice, step, [32, 32]);
                rms(&pixels(&drawn, span, 1.0, smooth_truth))
            });
            let found = order(&steps, &errors).unwrap();
            println!("{backend} {choice}: {found:.3} of {}", shown(&errors));
            assert!(
                (found - theory).abs() <= 0.15,
                "{backend} {choice}: order {found:.3}, not {theory}, of {}",
                shown(&errors)
            );
        }
    }
}

/// Emission and absorption in so many parts of constant scalar; `scalar` is a function of the share of the way.
fn along(
    transfer: &TransferFunction,
    length: f64,
    parts: u32,
    scalar: impl Fn(f64) -> f64,
) -> [f64; 4] {
    slabs(middles(parts).map(|share| {
        let scalar = scalar(share);
        let depth = transfer.extinction(scalar) * length / f64::from(parts);
        (transfer.color(scalar), depth)
    }))
}

fn parse(text: &str) -> TransferFunction {
    TransferFunction::parse("transfer.ron".as_ref(), text).unwrap()
}

#[test]
fn a_constant_volume_is_exact_at_any_step() {
    // Between two control points, at an entry of the tables of one scalar.
    let scalar = 4095.0 / 8191.0;
    let text = "(domain: data, color: [(0, (1, 0.2, 0)), (1, (0.1, 0.8, 1))], extinction: [(0, 0), (1, 0.6)])";
    let transfer = parse(text);
    let scene = stage(
        r#"path: "v_8x8x8_float32.raw""#,
        "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
        text,
        "",
    )
    .with_floats("v", [8, 8, 8], |_, _, _| scalar as f32);
    let span = (DVec3::splat(-0.5), DVec3::splat(7.5));
    let truth = |from: DVec3, to: DVec3| along(&transfer, from.distance(to), 1, |_| scalar);
    for backend in adapters() {
        for choice in choices("classify").iter().chain(&for_tests()[..1]) {
            for step in [0.3, 7.7, 32.0] {
                let drawn = draw(&scene, &backend, "compute", choice, step, [24, 24]);
                let error = worst(&pixels(&drawn, span, 0.0, truth));
                // The rounding of a ray's length: no choice and no step adds to it.
                assert!(error <= 5e-6, "{backend} {choice} {step}: {error}");
            }
        }
    }
}

#[test]
fn colours_stay_between_nothing_and_the_opacity_however_dense_a_segment_is() {
    // Extinction of up to 16 per voxel, with peaks and colours that jump; a field without any smoothness.
    let text = "(domain: data, points: [
        (at: 0, color: (1, 0, 0), extinction: 0), (at: 0.2, color: (0, 1, 0), extinction: 0.01),
        (at: 0.21, color: (1, 1, 1), extinction: 16), (at: 0.22, color: (0, 0, 0.1), extinction: 0),
        (at: 0.6, color: (0, 0, 1), extinction: 0), (at: 0.6, color: (1, 1, 0), extinction: 3),
        (at: 0.9, color: (0.2, 1, 0), extinction: 0), (at: 1, color: (1, 0, 1), extinction: 16)])";
    let noise = |x: u32, y: u32, z: u32| {
        let bits = (x * 73 + y * 179 + z * 283 + 7).wrapping_mul(2_654_435_761);
        (bits >> 16 & 1023) as f32 / 1023.0
    };
    let scene = stage(
        r#"path: "v_36x8x8_float32.raw""#,
        "look_at(eye: (-30, 9, 11), target: (17, 3.5, 3.5), fov_y: 16)",
        text,
        "",
    )
    .with_floats("v", [36, 8, 8], noise);
    for backend in adapters() {
        for choice in &choices("classify") {
            for step in [32.0, 4.0] {
                let [fragment, compute] =
                    STAGES.map(|form| draw(&scene, &backend, form, choice, step, [32, 32]).0);
                let mut differ = 0.0_f32;
                let mut above = 0.0_f32;
                let opacity = fragment.opacity.as_ref().unwrap();
                for (at, color) in fragment.color.iter().enumerate() {
                    for (seen, other) in color[..3].iter().zip(compute.color[at]) {
                        assert!(
                            seen.is_finite() && *seen >= 0.0,
                            "{backend} {choice} {step}: {color:?}"
                        );
                        differ = differ.max((seen - other).abs());
                        above = above.max(seen - opacity[at]);
                    }
                    assert!(
                        (0.0..=1.0).contains(&opacity[at]),
                        "{backend} {choice} {step}: {}",
                        opacity[at]
                    );
                }
                assert!(
                    above <= 1e-6,
                    "{backend} {choice} {step}: {above} above the opacity"
                );
                assert!(
                    differ <= 1e-5,
                    "{backend} {choice} {step}: forms differ by {differ}"
                );
            }
        }
    }
}

#[test]
fn four_lines_are_as_far_off_as_knittel_says() {
    // One segment through the volume: its depth is 0 to 3 by the way through it.
    let text = "(domain: data(from: 0, to: 1), color: (1, 1, 1), extinction: [(0, 0.25)])";
    let scene = stage(
        r#"path: "v_8x8x8_float32.raw""#,
        "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
        text,
        r#""attenuation": "four_lines""#,
    )
    .with_floats("v", [8, 8, 8], |_, _, _| 0.0);
    let span = (DVec3::splat(-0.5), DVec3::splat(7.5));
    for backend in adapters() {
        let drawn = draw(&scene, &backend, "compute", "integral_1d", 32.0, [40, 40]);
        let lines = |from: DVec3, to: DVec3| {
            let depth = 0.25 * from.distance(to);
            let lines = [
                (0.795_102_7, 0.0),
                (0.347_700_6, 0.262_390_9),
                (0.081_134_1, 0.692_492_3),
                (0.0, 1.0),
            ];
            [lines
                .iter()
                .map(|(slope, start)| slope * depth + start)
                .fold(1.0, f64::min); 4]
        };
        let exact = |from: DVec3, to: DVec3| [1.0 - (-0.25 * from.distance(to)).exp(); 4];
        let (of_lines, of_truth) = (
            worst(&pixels(&drawn, span, 0.0, lines)),
            worst(&pixels(&drawn, span, 0.0, exact)),
        );
        println!("{backend}: {of_lines:.2e} {of_truth:.6}");
        assert!(of_lines <= 5e-6, "{backend}: {of_lines}");
        assert!(
            (0.0215..0.0226).contains(&of_truth),
            "{backend}: {of_truth}"
        );
    }
}

#[test]
fn each_label_has_tables_of_its_own() {
    use super::segments::{BLUE_IS_1, CAMERAS, graph, stage};
    // `post` has no table, and is the truth. Labels with the table of segments of all lengths are refused, by name.
    let without = ["post", "preintegrated_3d"];
    for choice in &choices("classify") {
        if without.contains(&choice.as_str()) {
            continue;
        }
        let slots = |choice: &str| format!(r#""classify": "{choice}""#);
        let of = |choice: &str| {
            stage(|x, _, _| u32::from(x > 3), BLUE_IS_1)
                // Any field will do, for each label's transfer function is constant; means are not read in a constant one.
                .with_floats("v", [8, 8, 8], |x, y, z| (x + 2 * y + 3 * z) as f32 / 42.0)
                .with(
                    "graph.ron",
                    graph(
                        "(1, 1, 1)",
                        CAMERAS[0],
                        &slots(choice),
                        r#""step": 0.7, "preintegration_size": 128"#,
                    ),
                )
        };
        for backend in adapters() {
            let refused = of("preintegrated_3d").open("graph.ron", &[], &backend, [8, 8]);
            let findings = refused.err().unwrap();
            assert!(
                findings
                    .into_iter()
                    .any(|it| it.code == "labels-unsupported")
            );
            let [found, truth] =
                [of(choice), of("post")].map(|scene| render(&scene, &[], &backend, [32, 32]).0);
            let pairs = found
                .color
                .iter()
                .flatten()
                .zip(truth.color.iter().flatten());
            let error = pairs.fold(0.0_f32, |worst, (a, b)| worst.max((a - b).abs()));
            assert!(error <= 1e-5, "{backend} {choice}: {error}");
        }
    }
}
