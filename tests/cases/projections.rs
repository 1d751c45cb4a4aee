//! Projections against the trilinear field itself, in float64: a cubic in each cell.
//!
//! Scalars are shown as grey values of a window over the data, so a colour times the window's span is the scalar.

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_measure::order;
use volgraph_tests::trilinear::Trilinear;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

const DIMS: [u32; 3] = [12, 10, 8];

/// A quadratic with its largest value inside, 0 to 1 over the box.
fn quadratic(x: u32, y: u32, z: u32) -> f32 {
    let at = DVec3::new(f64::from(x) / 11.0, f64::from(y) / 9.0, f64::from(z) / 7.0);
    let from = at - DVec3::new(0.45, 0.55, 0.4);
    (0.95 - from.dot(DVec3::new(1.1, 0.9, 1.3) * from) + 0.2 * from.x * from.y) as f32
}

fn stage(technique: &str, params: &str) -> Stage {
    let slots = format!(r#"{{ "technique": "{technique}" }}"#);
    let params = format!(r#"{{ "window_unit": "data", {params} }}"#);
    let camera = "orbit(azimuth: 33, elevation: 21, fov_y: 35)";
    let text = graph(
        r#"path: "v_12x10x8_float32.raw""#,
        camera,
        "{}",
        &slots,
        &params,
    );
    Stage::new()
        .with_floats("v", DIMS, quadratic)
        .with("transfer.ron", "(points: [(at: 0, color: (1, 1, 1), opacity: 0), (at: 1, color: (1, 1, 1), opacity: 1)])")
        .with("graph.ron", text)
}

const LOW: DVec3 = DVec3::splat(-0.5);
const HIGH: DVec3 = DVec3::new(11.5, 9.5, 7.5);

/// The largest error of the opacity over all pixels that meet the box, how many these are, and the depth's.
fn worst(
    (picture, view): &(Picture, View),
    truth: impl Fn((DVec3, DVec3), (f64, f64)) -> (f64, Option<f64>),
) -> (f64, u32, f64) {
    let (mut error, mut met, mut deep) = (0.0_f64, 0, 0.0_f64);
    let opacity = picture.opacity.as_ref().unwrap();
    let depth = picture.depth.as_ref().unwrap();
    for y in 0..view.size[1] {
        for x in 0..view.size[0] {
            let ray = ray(view, x, y);
            let at = (y * view.size[0] + x) as usize;
            let Some(range) = box_interval(ray, LOW, HIGH).filter(|(near, far)| far - near > 0.05)
            else {
                continue;
            };
            met += 1;
            let (value, place) = truth(ray, range);
            error = error.max((f64::from(opacity[at]) - value).abs());
            if let Some(place) = place {
                deep = deep.max((f64::from(depth[at]) - place).abs());
            }
        }
    }
    (error, met, deep)
}

#[test]
fn the_extremes_are_those_of_the_field_at_any_step() {
    let field = Trilinear::new(DIMS, quadratic);
    let negated = Trilinear::new(DIMS, |x, y, z| -quadratic(x, y, z));
    for (technique, window) in [
        ("mip", r#""window_low": 0.0, "window_high": 1.0"#),
        // Down to the corners, which lie lower.
        ("minip", r#""window_low": -1.0, "window_high": 1.0"#),
    ] {
        let truth = |ray: (DVec3, DVec3), range: (f64, f64)| {
            if technique == "mip" {
                let (value, place) = field.largest(ray, range);
                (value, Some(place))
            } else {
                // The smallest lies where the field is clamped, and so at many places.
                let (value, _) = negated.largest(ray, range);
                ((1.0 - value) / 2.0, None)
            }
        };
        for backend in adapters() {
            for form in STAGES {
                for step in ["0.4", "3", "16"] {
                    let stage = stage(technique, window);
                    let sets = [format!("image.stage={form}"), format!("image.step={step}")];
                    let drawn = render(
                        &stage,
                        &sets.each_ref().map(String::as_str),
                        &backend,
                        [40, 36],
                    );
                    let (error, met, deep) = worst(&drawn, truth);
                    // The value to f32's rounding; the place of a flat maximum only to its root.
                    assert!(
                        error < 1e-5 && met > 300 && deep < 0.05,
                        "{technique} {backend} {form} step {step}: {error}, depth {deep}, over {met} pixels"
                    );
                }
            }
        }
    }
}

/// Of samples alone the maximum is short: in the middle of a cell by the square of the step (f'' h² / 8 at most), at a
/// kink between cells by the step itself.
#[test]
fn the_maximum_of_samples_has_an_order_and_that_of_the_field_no_error() {
    let field = Trilinear::new(DIMS, quadratic);
    let truth = |ray: (DVec3, DVec3), range: (f64, f64)| field.largest(ray, range).0;
    let rmse = |backend: &str, extremum: &str, step: f64| {
        let stage = stage("mip", r#""window_low": 0.0, "window_high": 1.0"#);
        let sets = [
            format!("image.step={step}"),
            format!("image.extremum={extremum}"),
        ];
        let (picture, view) = render(
            &stage,
            &sets.each_ref().map(String::as_str),
            backend,
            [40, 36],
        );
        let opacity = picture.opacity.unwrap();
        let (mut sum, mut count) = (0.0, 0.0);
        for y in 0..36 {
            for x in 0..40 {
                let ray = ray(&view, x, y);
                if let Some(range) =
                    box_interval(ray, LOW, HIGH).filter(|(near, far)| far - near > 4.0)
                {
                    sum += (truth(ray, range) - f64::from(opacity[(y * 40 + x) as usize])).powi(2);
                    count += 1.0;
                }
            }
        }
        (sum / count).sqrt()
    };
    for backend in adapters() {
        let steps = [4.0, 2.0, 1.0, 0.5, 0.25];
        let errors = steps.map(|step| rmse(&backend, "samples", step));
        let order = order(&steps, &errors).unwrap();
        assert!(
            (1.0..2.0).contains(&order),
            "{backend}: {order}, {errors:?}"
        );
        for step in steps {
            let error = rmse(&backend, "field", step);
            assert!(error < 2e-6, "{backend}: {error} at step {step}");
        }
    }
}

#[test]
fn the_mean_and_the_absorption_are_integrals_of_the_field() {
    let field = Trilinear::new(DIMS, quadratic);
    // Half of the smallest side of the box is 4 voxels.
    for (technique, params) in [
        ("average", r#""window_low": -1.0, "window_high": 1.0"#),
        (
            "xray",
            r#""window_low": -2.0, "window_high": -1.0, "absorption": 0.2"#,
        ),
    ] {
        let truth = |ray: (DVec3, DVec3), (near, far): (f64, f64)| {
            let integral = field.integral(ray, (near, far));
            let length = far - near;
            let value = if technique == "average" {
                0.5 * (1.0 + integral / length)
            } else {
                1.0 - (-0.2 / 4.0 * (integral + 2.0 * length)).exp()
            };
            (value, None)
        };
        for backend in adapters() {
            for form in STAGES {
                let error = |step: f64| {
                    let stage = stage(technique, params);
                    let sets = [format!("image.stage={form}"), format!("image.step={step}")];
                    let drawn = render(
                        &stage,
                        &sets.each_ref().map(String::as_str),
                        &backend,
                        [40, 36],
                    );
                    let (error, met, _) = worst(&drawn, truth);
                    assert!(met > 300);
                    error
                };
                // The trapezoid rule: a quarter of the error at half the step, over the kinks between cells as well.
                let (coarse, fine) = (error(0.4), error(0.05));
                assert!(
                    coarse < 2e-3 && fine < 3e-5 && fine < coarse / 40.0,
                    "{technique} {backend} {form}: {coarse}, {fine}"
                );
            }
        }
    }
}

#[test]
fn a_projection_of_the_field_between_samples_needs_the_trilinear_one() {
    let refused = stage("mip", r#""window_low": 0.0"#)
        .open(
            "graph.ron",
            &["image.slots.reconstruct=nearest", "image.extremum=field"],
            &adapters()[0],
            [8, 8],
        )
        .and_then(|mut session| session.render())
        .err()
        .unwrap();
    assert!(
        refused.to_string().contains("set `extremum` to `samples`"),
        "{refused}"
    );
    // Who does not say gets what fits.
    let sets = ["image.slots.reconstruct=nearest"];
    let _ = render(
        &stage("mip", r#""window_low": 0.0"#),
        &sets,
        &adapters()[0],
        [8, 8],
    );
}
