//! How pictures of clipped volumes depend on the step.

use std::f64::consts::PI;

use volgraph::Picture;
use volgraph_tests::{Stage, adapters, graph, render};

use super::PERSPECTIVE;

const SIZE: [u32; 2] = [40, 40];

/// Root mean square of the colour's difference, of 255.
fn rmse(picture: &Picture, truth: &Picture) -> f64 {
    let pixels = picture.color.iter().zip(&truth.color);
    let squares: Vec<f64> = pixels
        .flat_map(|(pixel, truth)| (0..3).map(|at| f64::from(pixel[at] - truth[at]).powi(2)))
        .collect();
    255.0 * (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// The order: the slope of a line through the logarithms of step and error.
fn order(steps: &[f64], errors: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64;
    let (x, y) = (mean(steps), mean(errors));
    let pairs = || {
        steps
            .iter()
            .zip(errors)
            .map(|(step, error)| (step.ln() - x, error.ln() - y))
    };
    pairs().map(|(dx, dy)| dx * dy).sum::<f64>() / pairs().map(|(dx, _)| dx * dx).sum::<f64>()
}

/// A field of one slow wave along each axis of 64³ voxels, on a rise along y, and a transfer function without an edge.
fn waves(slots: &str, params: &str, rise: f64) -> Stage {
    let wave = |at: u32| (2.0 * PI * f64::from(at) / 90.0).sin();
    Stage::new()
        .with_floats("v", [64; 3], move |x, y, z| {
            let waves = wave(x) + wave(y + 20) + wave(z + 40);
            (0.5 + (0.15 - 0.1 * rise) * waves + rise * (f64::from(y) / 64.0 - 0.5)) as f32
        })
        .with(
            "transfer.ron",
            "(domain: data, color: [(0.0, (1, 0.2, 0.1)), (1.0, (0.1, 0.4, 1))], extinction: [(0.0, 0.0), (1.0, 0.08)])",
        )
        .with(
            "graph.ron",
            graph(
                r#"path: "v_64x64x64_float32.raw""#,
                PERSPECTIVE,
                r#"{ "color": [0, 0, 0, 0] }"#,
                slots,
                params,
            ),
        )
}

#[test]
fn an_accurate_cut_converges_as_the_quadrature_does_and_a_naive_one_with_the_step() {
    let steps = [1.0, 4.0, 16.0];
    let shapes = [
        (
            "planes",
            r#""planes": 2, "plane_1": [0.3, -0.5, 0.7, 0.05], "plane_2": [-0.9, 0.2, 0.3, -0.5]"#,
        ),
        (
            "sphere",
            r#""clip_centre": [0.3, -0.9, 0.4], "clip_radius": 0.8, "clip_keep": "outside""#,
        ),
        (
            "box",
            r#""clip_low": [0.33, 0.1, 0.2], "clip_high": [0.9, 0.71, 0.77]"#,
        ),
    ];
    for (clip, shape) in shapes {
        // Pre-integrated segments that a cut makes shorter keep the order as well.
        let classify = if clip == "sphere" {
            "post"
        } else {
            "preintegrated_2d"
        };
        let slots = format!(r#"{{ "clip": "{clip}", "classify": "{classify}" }}"#);
        let params = format!(r#"{{ "early_termination": 0.0, {shape} }}"#);
        let stage = waves(&slots, &params, 0.0);
        for backend in adapters() {
            let picture = |step: f64, method: &str| {
                let step = format!("image.step={step}");
                let method = format!("image.clip_method={method}");
                render(&stage, &[&step, &method], &backend, SIZE).0
            };
            let truth = picture(0.125, "accurate");
            let errors = |method: &str| steps.map(|step| rmse(&picture(step, method), &truth));
            let (accurate, naive) = (errors("accurate"), errors("naive"));
            let orders = [order(&steps, &accurate), order(&steps, &naive)];
            println!(
                "{clip} {classify} {backend}: accurate {accurate:.4?}, naive {naive:.4?}, orders {orders:.2?}"
            );
            // Midpoints and tables are of order 2, whole segments of order 1.
            assert!(orders[0] > 1.7, "{clip} {classify} {backend}: {orders:?}");
            assert!(orders[1] < 1.3, "{clip} {classify} {backend}: {orders:?}");
        }
    }
}

/// Sixty atoms out of which a sphere is cut, by a clip volume of distances to it.
fn atoms(clip: &str, params: &str) -> Stage {
    let text = format!(
        r#"(
    sources: {{
        "volume": analytic(field: "c60", dims: (64, 64, 64)),
        "clip": analytic(field: "sphere", dims: (40, 40, 40), radius: 0.7),
        "colors": transfer(path: "transfer.ron"),
    }},
    camera: orbit(azimuth: 33, elevation: 21, fov_y: 40),
    nodes: {{
        "box": (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "raycast",
                  in: {{ "volume": "volume", "transfer": "colors", "rays": "box", "clip_volume": "clip" }},
                  slots: {{ "clip": "{clip}", "classify": "preintegrated_2d" }},
                  params: {{ "early_termination": 0.0, {params} }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    );
    Stage::new().with("graph.ron", text).with(
        "transfer.ron",
        "(domain: data, color: [(0.0, (0.1, 0.8, 0.2)), (1.0, (1, 0.4, 0.1))], extinction: [(0.1, 0.0), (1.0, 0.3)])",
    )
}

#[test]
fn a_sphere_cut_out_of_32_slabs_shows_no_slices() {
    // After figure 3 of Röttger et al. 2003: 32 segments through the volume.
    let clip = r#""clip_isovalue": 0.5, "clip_isovalue_unit": "data", "clip_keep": "outside""#;
    let (stage, unclipped) = (atoms("volume", clip), atoms("none", ""));
    for backend in adapters() {
        let error = |set: &str| {
            let picture = |step: &str| render(&stage, &[step, set], &backend, [64, 64]).0;
            rmse(&picture("image.step=2"), &picture("image.step=0.0625"))
        };
        let accurate = error("image.clip_method=accurate");
        let picture = |step: &str| render(&unclipped, &[step], &backend, [64, 64]).0;
        let whole = rmse(&picture("image.step=2"), &picture("image.step=0.0625"));
        let truth = render(&stage, &["image.step=0.0625"], &backend, [64, 64]).0;
        let slices = ["image.step=2", "image.clip_method=naive"];
        let naive = rmse(&render(&stage, &slices, &backend, [64, 64]).0, &truth);
        println!(
            "{backend}: accurate {accurate:.4}, naive {naive:.4}, unclipped {whole:.4} of 255"
        );
        // The cut adds nothing to the error that such long segments make of the whole volume.
        assert!(accurate < 1.1 * whole, "{backend}: {accurate} and {whole}");
        assert!(naive > 4.0 * accurate, "{backend}: {accurate} and {naive}");
    }
}

#[test]
fn a_lit_cut_does_not_depend_on_the_step_to_first_order() {
    let slots = r#"{ "clip": "planes", "light": "phong", "gradient": "central" }"#;
    let params = r#"{ "early_termination": 0.0, "light_1": [0.6, -0.5, 0.7, 0.0], "plane_1": [0.3, 0.8, -0.5, 0.0] }"#;
    let stage = waves(slots, params, 0.8).with(
        "transfer.ron",
        "(domain: data, color: (0.9, 0.8, 0.7), extinction: [(0.0, 0.1), (1.0, 0.4)])",
    );
    // None of them divides the voxel behind the cut.
    let steps = [0.13, 0.27, 0.57];
    for backend in adapters() {
        let picture = |step: f64| {
            let step = format!("image.step={step}");
            render(&stage, &[&step], &backend, SIZE).0
        };
        let truth = picture(0.015625);
        let error = |step: f64| rmse(&picture(step), &truth);
        let (errors, coarse) = (steps.map(error), [1.0, 2.0, 4.0, 8.0].map(error));
        let order = order(&steps, &errors);
        println!("{backend}: {errors:.4?}, order {order:.2}, then {coarse:.4?}");
        assert!(order > 1.7, "{backend}: {errors:?}");
    }
}
