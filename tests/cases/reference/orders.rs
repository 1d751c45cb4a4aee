//! Every technique, cut, light and reconstruction at finer and finer steps: what the device draws must fall towards the
//! reference, and be beside it in the end. A wrong reference would leave a floor.

use volgraph_measure::order;
use volgraph_tests::truth::truth;
use volgraph_tests::{Stage, adapters, render};

const SIZE: [u32; 2] = [24, 24];

/// A smooth field with bumps, about 0 to 1.
fn bumps(x: u32, y: u32, z: u32) -> f32 {
    let [x, y, z] = [x, y, z].map(|index| f64::from(index) * 0.55);
    (0.5 + 0.2 * (x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos())) as f32
}

fn stage(slots: &str, params: &str) -> Stage {
    // A label has parameters that its shader knows.
    let own = if slots.contains("isosurface") {
        r#""isovalue": 0.5"#
    } else if slots.contains("phong") {
        r#""specular": 0.6"#
    } else {
        ""
    };
    let graph = format!(
        r#"(
    sources: {{
        "volume": volume(path: "v_12x12x12_float32.raw", spacing: (1, 1.2, 0.9)),
        "other": volume(path: "o_6x6x6_float32.raw"),
        "labels": volume(path: "l_9x9x9_float32.raw"),
        "colors": transfer(path: "transfer.ron"),
        "meaning": segments(path: "segments.ron"),
    }},
    camera: orbit(azimuth: 28, elevation: 24, fov_y: 30),
    nodes: {{
        "box": (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "raycast",
                  in: {{ "volume": "volume", "transfer": "colors", "rays": "box", "clip_volume": "other",
                         "labels": "labels", "segments": "meaning" }},
                  slots: {{ {slots} }},
                  params: {{ "volume_storage": "r32float", "label_placement": "box", {params} }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    );
    Stage::new()
        .with_floats("v", [12, 12, 12], bumps)
        .with_floats("o", [6, 6, 6], |x, y, z| {
            let from = [x, y, z].map(|index| (index as f32 - 2.4) / 2.5);
            from.iter().map(|part| part * part).sum::<f32>().sqrt()
        })
        .with_floats("l", [9, 9, 9], |x, y, z| {
            if x < 3 { 2.0 } else if x + y + z > 12 { 1.0 } else { 0.0 }
        })
        .with(
            "transfer.ron",
            "(domain: data, color: [(0.2, (1, 0.3, 0.1)), (0.8, (0.2, 0.5, 1))], extinction: [(0.3, 0), (0.9, 0.9)],
              material: [(at: 0.3, ambient: 0.1, diffuse: 0.9), (at: 0.8, ambient: 0.5, diffuse: 0.4, specular: 0.5)])",
        )
        .with("blue.ron", "(domain: data, color: (0, 0.2, 1), extinction: [(0.2, 0), (0.8, 0.6)])")
        .with("segments.ron", format!(r#"(segments: [
            (label: 1, transfer: "blue.ron", params: {{ {own} }}), (label: 2, visible: false)])"#))
        .with("graph.ron", graph)
}

const LIT: &str = r#""light": "phong""#;
const LAMPS: &str = r#""lights": 2, "light_1": [0.4, -0.7, 0.5, 0], "light_2": [1.5, -2, 1, 1], "light_2_color": [0.5, 0.4, 0.2]"#;

/// What is drawn: slots, parameters, the order that is expected at least, the largest RMSE at the finest step.
type Drawn = (&'static str, &'static str, f64, f64);

/// Smooth integrands have the quadrature's order 2. Where light jumps at a plane of the field's or a silhouette, a pixel
/// in so many is off by a part of a step: less than 2, and more than 1. What is exact at any step has no order.
const EXACT: f64 = 0.0;

fn all() -> Vec<(String, String, f64, f64)> {
    let iso = r#""technique": "isosurface""#;
    let faces = r#""isovalue": 0.55"#;
    let table: [Drawn; 16] = [
        ("", "", 1.8, 1e-4),
        (r#""classify": "preintegrated_2d""#, "", 1.5, 3e-4),
        (
            r#""clip": "planes""#,
            r#""plane_1": [1, 0.4, 0.2, 0.1]"#,
            1.8,
            1e-4,
        ),
        (
            r#""clip": "volume""#,
            r#""clip_isovalue": 0.9, "clip_isovalue_unit": "data", "clip_volume_place": "box", "clip_step": 0.0625"#,
            1.8,
            1e-4,
        ),
        (r#""reconstruct": "nearest""#, "", 0.7, 1e-2),
        (r#""reconstruct": "tricubic""#, "", 1.8, 1e-4),
        (r#""reconstruct": "catmull_rom""#, "", 1.8, 1e-4),
        (r#""labels": "volume""#, "", 1.8, 1e-4),
        (
            r#""labels": "volume""#,
            r#""label_boundary": "blocky""#,
            1.8,
            1e-4,
        ),
        (r#""technique": "mip""#, "", EXACT, 1e-6),
        (
            r#""technique": "minip", "clip": "sphere""#,
            r#""clip_radius": 0.9"#,
            EXACT,
            1e-6,
        ),
        (r#""technique": "average""#, "", 1.8, 1e-4),
        (
            r#""technique": "xray", "clip": "box""#,
            r#""clip_high": [0.7, 1, 0.6], "clip_keep": "outside", "window_low": 0.3"#,
            1.8,
            1e-4,
        ),
        (
            r#""technique": "isosurfaces_translucent""#,
            r#""refinement": "cubic""#,
            EXACT,
            1e-5,
        ),
        (
            r#""technique": "isosurface_dvr""#,
            r#""refinement": "cubic", "isovalue": 0.5"#,
            1.5,
            1e-4,
        ),
        (
            r#""technique": "isosurface", "labels": "volume""#,
            r#""refinement": "cubic", "isovalue": 0.6"#,
            EXACT,
            1e-5,
        ),
    ];
    let mut all: Vec<_> = table
        .iter()
        .map(|(slots, params, least, bound)| {
            (format!("{slots},"), format!("{params},"), *least, *bound)
        })
        .collect();
    for gradient in ["stored", "central", "analytic", "tricubic"] {
        let slots = format!(r#"{LIT}, "gradient": "{gradient}""#);
        // Trilinear gradients jump from cell to cell: a segment across a face is off by a part of the jump, order 1.
        let (least, bound) = if gradient == "analytic" {
            (0.9, 5e-4)
        } else {
            (1.2, 1e-4)
        };
        all.push((slots.clone(), LAMPS.to_owned(), least, bound));
        // Surfaces have the gradient of one point, at any step.
        all.push((
            format!("{slots}, {iso}"),
            format!(r#"{LAMPS}, {faces}, "refinement": "cubic""#),
            EXACT,
            1e-4,
        ));
    }
    for (slots, params) in [
        (r#""gradient_method": "sobel", "clip": "sphere""#, ""),
        (r#""material": "transfer""#, ""),
        (
            r#""material": "preintegrated", "classify": "preintegrated_2d""#,
            "",
        ),
        (r#""labels": "volume""#, ""),
        (
            r#""technique": "isosurface_dvr""#,
            r#", "isovalue": 0.5, "refinement": "cubic""#,
        ),
        (
            r#""clip": "box""#,
            r#", "clip_keep": "outside", "clip_low": [0.3, 0, 0.4], "clip_high": [1, 0.7, 1]"#,
        ),
    ] {
        all.push((
            format!("{LIT}, {slots}"),
            format!("{LAMPS}{params}"),
            1.2,
            1e-4,
        ));
    }
    all.push((
        r#""light": "phong_ends", "classify": "preintegrated_2d""#.to_owned(),
        LAMPS.to_owned(),
        1.2,
        1e-4,
    ));
    for shadow in ["surface", "transmittance"] {
        all.push((
            format!(r#"{LIT}, {iso}, "shadow": "{shadow}", "gradient": "analytic""#),
            format!(r#"{LAMPS}, {faces}, "refinement": "cubic", "shadow_step": 0.125"#),
            EXACT,
            1e-4,
        ));
    }
    all
}

#[test]
fn finer_steps_go_to_the_reference_without_light() {
    hold(|slots| !slots.contains("\"light\""));
}

#[test]
fn finer_steps_go_to_the_reference_with_light() {
    hold(|slots| slots.contains("\"light\""));
}

fn hold(is_wanted: impl Fn(&str) -> bool) {
    let mut wrong = Vec::new();
    let backends = adapters();
    let all = all().into_iter().filter(|(slots, ..)| is_wanted(slots));
    for (at, (slots, params, least, bound)) in (0_usize..).zip(all) {
        let params = if params.trim().is_empty() || params == "," {
            String::new()
        } else {
            params
        };
        let slots = if slots == "," { String::new() } else { slots };
        let is_composed = !["mip", "minip", "average", "xray"]
            .iter()
            .any(|name| slots.contains(&format!("\"{name}\"")))
            && !slots.contains("\"isosurface\"");
        let stage = stage(&slots, &params);
        let (truth, _) = truth(&stage, &[], SIZE);
        // The backends run the same walk (see `agreement`), so they take turns.
        let backend = &backends[at % backends.len()];
        // Jumps of light are met or missed: a few more halvings, until many rays average over them.
        let steps: &[f64] = if least == EXACT {
            &[0.125]
        } else if slots.contains("phong") {
            &[0.25, 0.125, 0.0625, 0.03125]
        } else {
            &[0.5, 0.25, 0.125]
        };
        let error = |step: &f64| {
            let step = format!("image.step={step}");
            let mut sets = vec![step.as_str()];
            if is_composed {
                sets.push("image.early_termination=0");
            }
            let (picture, _) = render(&stage, &sets, backend, SIZE);
            truth.compare(&picture).unwrap().rmse
        };
        let errors: Vec<f64> = steps.iter().map(error).collect();
        let order = order(steps, &errors).unwrap_or(0.0);
        let figures: Vec<String> = errors.iter().map(|error| format!("{error:.1e}")).collect();
        let figures = figures.join(" ");
        let line = format!("{slots} {params} {backend}: order {order:.2}, rmse {figures}");
        let _ = std::io::Write::write_fmt(&mut std::io::stderr(), format_args!("{line}\n"));
        if errors[errors.len() - 1] > bound || (least > EXACT && order < least) {
            wrong.push(line);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
