//! How pictures of clipped volumes depend on the step, and how cut faces are lit.

use std::f64::consts::PI;

use glam::DVec3;
use volgraph::Picture;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

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
        for classify in ["post", "preintegrated_2d"] {
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

/// Blinn-Phong by the default light at infinity: the factor of the colour, and what the highlight adds.
fn phong(normal: DVec3, direction: DVec3, light: DVec3) -> (f64, f64) {
    let light = light.normalize();
    let diffuse = normal.dot(light);
    if diffuse <= 0.0 {
        return (0.3, 0.0);
    }
    let half_way = (light - direction).normalize();
    (
        0.3 + 0.7 * diffuse,
        0.25 * normal.dot(half_way).max(0.0).powi(32),
    )
}

const LIGHT: DVec3 = DVec3::new(0.6, -0.5, 0.7);
const COLOR: [f64; 3] = [0.7, 0.4, 0.2];

/// A solid block that a clip shape cuts, lit from the side; `clip` is the source of a clip volume.
fn solid(camera: &str, technique: &str, clip: &str, params: &str) -> Stage {
    let own = if technique == "dvr" {
        r#""early_termination": 0.0"#
    } else {
        r#""surface_color": [0.7, 0.4, 0.2], "isovalue": 0.5, "isovalue_unit": "data""#
    };
    let params = format!(r#"{{ "light_1": [0.6, -0.5, 0.7, 0.0], {own}, {params} }}"#);
    let slots = format!(r#"{{ "technique": "{technique}", "clip": "{clip}", "light": "phong" }}"#);
    let text = graph(
        r#"path: "v_12x10x8_float32.raw", spacing: (1, 1.5, 2)"#,
        camera,
        r#"{ "color": [0, 0, 0, 0] }"#,
        &slots,
        &params,
    )
    .replace(
        "sources: {",
        &format!(r#"sources: {{ "clip": volume({CLIP}),"#),
    )
    .replace(
        r#""rays": "box""#,
        r#""rays": "box", "clip_volume": "clip""#,
    );
    Stage::new()
        .with_floats("v", [12, 10, 8], |_, _, _| 0.75)
        .with_floats("c", [9, 7, 8], |x, y, z| {
            SLOPE.dot(clip_world(x, y, z)) as f32
        })
        .with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (0.7, 0.4, 0.2), opacity: 1)])",
        )
        .with("graph.ron", text)
}

/// The clip volume: a ramp, with voxels of its own, around the block.
const CLIP: &str = r#"path: "c_9x7x8_float32.raw", spacing: (3, 5, 4), origin: (-6, -8, -7)"#;
const SLOPE: DVec3 = DVec3::new(0.2, 0.3, -0.4);

fn clip_world(x: u32, y: u32, z: u32) -> DVec3 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * DVec3::new(3.0, 5.0, 4.0)
        - DVec3::new(6.0, 8.0, 7.0)
}

#[test]
fn a_cut_face_is_lit_by_the_normal_of_the_cut() {
    let (low, high) = (DVec3::new(-0.5, -0.75, -1.0), DVec3::new(11.5, 14.25, 15.0));
    let (centre, half_side) = (0.5 * (low + high), 6.0);
    let plane = DVec3::new(-0.9, 0.5, -0.6);
    let shapes = [
        (
            "planes",
            r#""plane_1": [-0.9, 0.5, -0.6, 0.05]"#,
            plane.normalize(),
            plane.normalize().dot(centre) + 0.05 * half_side,
            PERSPECTIVE,
        ),
        (
            "volume",
            r#""clip_isovalue": 0.3, "clip_isovalue_unit": "data""#,
            SLOPE.normalize(),
            0.3 / SLOPE.length(),
            PERSPECTIVE,
        ),
        (
            "volume",
            r#""clip_isovalue": 0.3, "clip_isovalue_unit": "data", "clip_keep": "outside""#,
            -SLOPE.normalize(),
            -0.3 / SLOPE.length(),
            "orbit(azimuth: 213, elevation: -21, fov_y: 40)",
        ),
    ];
    for (clip, params, normal, distance, camera) in shapes {
        // Any step: the first segments behind a cut are lit by it.
        for (technique, step) in [("dvr", 0.3), ("dvr", 4.0), ("isosurface", 1.0)] {
            let params = format!(r#""step": {step}, {params}"#);
            let stage = solid(camera, technique, clip, &params);
            for backend in adapters() {
                for form in STAGES {
                    let set = format!("image.stage={form}");
                    let (picture, view) = render(&stage, &[&set], &backend, SIZE);
                    let depth = picture.depth.unwrap();
                    let mut faces = 0;
                    for (at, pixel) in (0..).zip(&picture.color) {
                        let line = ray(&view, at % SIZE[0], at / SIZE[0]);
                        let Some((near, far)) = box_interval(line, low, high) else {
                            continue;
                        };
                        let slope = normal.dot(line.1);
                        let cut = (distance - normal.dot(line.0)) / slope;
                        // Two voxels are opaque whatever the light; thinner slivers are not.
                        if slope < 0.0 || cut < near + 0.01 || cut > far - 2.0 {
                            continue;
                        }
                        faces += 1;
                        let facing = -normal;
                        let (share, highlight) = phong(facing, line.1, LIGHT);
                        for channel in 0..3 {
                            let expected = COLOR[channel] * share + highlight;
                            let error = (f64::from(pixel[channel]) - expected).abs();
                            assert!(
                                error < 2e-4,
                                "{clip} {technique} {step} {backend} {form}: {pixel:?}, not {expected}"
                            );
                        }
                        if technique == "isosurface" {
                            let error = (f64::from(depth[at as usize]) - cut).abs();
                            assert!(error < 1e-4, "{clip} {backend} {form}: depth {error}");
                        }
                    }
                    assert!(faces > 100, "{clip} {params}: {faces} pixels show the cut");
                }
            }
        }
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
    let steps = [0.125, 0.25, 0.5];
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

#[test]
fn a_curved_cut_is_where_the_interpolated_clip_volume_says() {
    // A sphere's distances in voxels three times as large as the block's: a cubic along each ray in each voxel.
    let stage = solid(PERSPECTIVE, "isosurface", "volume", r#""step": 1.0, "clip_isovalue": 2.0, "clip_isovalue_unit": "data", "clip_keep": "outside""#)
        .with_floats("c", [9, 7, 8], |x, y, z| {
            (8.0 - clip_world(x, y, z).distance(DVec3::new(7.0, 2.0, 7.0))) as f32
        });
    let sphere: Vec<f32> = (0..9 * 7 * 8)
        .map(|at| {
            (8.0 - clip_world(at % 9, at / 9 % 7, at / 63).distance(DVec3::new(7.0, 2.0, 7.0)))
                as f32
        })
        .collect();
    let field = |world: DVec3| {
        let at = ((world + DVec3::new(6.0, 8.0, 7.0)) / DVec3::new(3.0, 5.0, 4.0))
            .clamp(DVec3::ZERO, DVec3::new(8.0, 6.0, 7.0));
        let low = at.floor().min(DVec3::new(7.0, 5.0, 6.0));
        let part = at - low;
        let mut sum = 0.0;
        for corner in 0..8_u32 {
            let is_high = [corner & 1, corner >> 1 & 1, corner >> 2 & 1].map(f64::from);
            let index = low + DVec3::from_array(is_high);
            let weight: f64 = (0..3)
                .map(|axis| {
                    if is_high[axis] > 0.5 {
                        part[axis]
                    } else {
                        1.0 - part[axis]
                    }
                })
                .product();
            sum += weight * f64::from(sphere[(index.x + 9.0 * (index.y + 7.0 * index.z)) as usize]);
        }
        sum - 2.0
    };
    let (low, high) = (DVec3::new(-0.5, -0.75, -1.0), DVec3::new(11.5, 14.25, 15.0));
    for backend in adapters() {
        let (picture, view) = render(&stage, &[], &backend, SIZE);
        let depth = picture.depth.unwrap();
        let (mut faces, mut worst) = (0, 0.0_f64);
        for (at, seen) in (0..).zip(&depth) {
            let (origin, direction) = ray(&view, at % SIZE[0], at / SIZE[0]);
            let Some((near, far)) = box_interval((origin, direction), low, high) else {
                continue;
            };
            // Rays that enter where it is cut away; the first change of side is the face, unless it is a sliver.
            let value = |distance: f64| field(origin + direction * distance);
            if value(near) <= 1e-3 {
                continue;
            }
            let fine = (far - near) / 4096.0;
            let Some(first) = (1..4096).find(|turn| value(near + f64::from(*turn) * fine) < 0.0)
            else {
                continue;
            };
            let (mut a, mut b) = (
                near + f64::from(first - 1) * fine,
                near + f64::from(first) * fine,
            );
            for _ in 0..40 {
                let middle = 0.5 * (a + b);
                if value(middle) < 0.0 {
                    b = middle;
                } else {
                    a = middle;
                }
            }
            faces += 1;
            let error = (f64::from(*seen) - a).abs();
            worst = worst.max(error);
        }
        println!("{backend}: {worst:.1e} world units over {faces} pixels");
        assert!(faces > 60, "{faces} pixels show the cut");
        // The refinements leave a thousandth of a clip voxel, which is 3 to 5 world units wide.
        assert!(worst < 3e-3, "{backend}: {worst}");
    }
}
