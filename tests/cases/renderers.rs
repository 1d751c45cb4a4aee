//! Slices and multi-pass rays against closed forms, the raycast and the reference, on every backend.

use glam::DVec3;
use volgraph::{Findings, Picture};
use volgraph_measure::compare_without_flip;
use volgraph_tests::truth::truth;
use volgraph_tests::{Stage, adapters, box_interval, ray, render};

const CAMERAS: [&str; 4] = [
    "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
    "orbit(azimuth: 33, elevation: 21, projection: orthographic)",
    // Inside of the volume, and one that looks along a face.
    "look_at(eye: (3.2, 2.1, 4.4), target: (0.0, 1.0, 0.0), fov_y: 70)",
    "look_at(eye: (3.5, -20.0, 3.5), target: (3.5, 0.0, 3.5), fov_y: 30)",
];

const SIZE: [u32; 2] = [49, 41];

/// A picture of a volume by a node kind, with nothing behind it: alpha is the opacity.
fn graph(kind: &str, camera: &str, slots: &str, params: &str) -> String {
    let rays = if kind == "raycast" {
        r#", "rays": "box""#
    } else {
        ""
    };
    format!(
        r#"(
    sources: {{ "volume": volume(path: "v_8x8x8_float32.raw"), "colors": transfer(path: "transfer.ron") }},
    camera: {camera},
    nodes: {{
        "box": (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "{kind}", in: {{ "volume": "volume", "transfer": "colors"{rays} }}, slots: {slots}, params: {params}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    )
}

/// A smooth field under a smooth transfer function.
fn waves(kind: &str, camera: &str, slots: &str, params: &str) -> Stage {
    let wave = |x: u32, y: u32, z: u32| {
        0.5 + 0.5 * (0.9 * x as f32 + 0.4 * (y as f32).sin() - 0.6 * z as f32).sin()
    };
    Stage::new()
        .with_floats("v", [8, 8, 8], wave)
        .with(
            "transfer.ron",
            "(domain: data, points: [(at: 0, color: (0.1, 0.2, 0.9), opacity: 0), (at: 0.6, color: (0.9, 0.8, 0.1), opacity: 0.3), (at: 1, color: (1, 0.1, 0.1), opacity: 0.6)])",
        )
        .with("graph.ron", graph(kind, camera, slots, params))
}

/// The formats that a backend blends: f32 where it can.
fn formats(backend: &str) -> Vec<&'static str> {
    let stage = waves("slices", CAMERAS[0], "{}", r#"{ "format": "rgba32float" }"#);
    let can = |backend: &str| stage.open("graph.ron", &[], backend, [8, 8]).is_ok();
    let all = ["rgba8unorm", "rgba16float", "rgba32float"];
    all.into_iter()
        .filter(|format| *format != "rgba32float" || can(backend))
        .collect()
}

fn largest(a: &Picture, b: &Picture) -> f64 {
    compare_without_flip(a, b).unwrap().max.error
}

fn worst_opacity(stage: &Stage, backend: &str, sets: &[&str]) -> f64 {
    let (picture, view) = render(stage, sets, backend, SIZE);
    let (low, high) = (DVec3::splat(-0.5), DVec3::splat(7.5));
    let mut worst = 0.0_f64;
    let mut met = 0;
    for y in 0..picture.height {
        for x in 0..picture.width {
            let expected = match box_interval(ray(&view, x, y), low, high) {
                Some((near, far)) => {
                    met += 1;
                    1.0 - 0.9_f64.powf(far - near)
                }
                None => 0.0,
            };
            let color = picture.color[(y * picture.width + x) as usize];
            worst = worst.max((f64::from(color[3]) - expected).abs());
        }
    }
    assert!(met > 200, "{met}");
    worst
}

fn constant(kind: &str, camera: &str, params: &str) -> Stage {
    Stage::new()
        .with_floats("v", [8, 8, 8], |_, _, _| 0.5)
        .with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (1, 0.5, 0.2), opacity: 0.1)])",
        )
        .with("graph.ron", graph(kind, camera, "{}", params))
}

/// No slab is lost at an outline or a face, and each is as long as its ray, in perspective and inside of the box as well.
/// Blending rounds once for each of up to 22 slabs: f32 not at all, f16 by 2^-12 at most, 8 bits by 1/510.
#[test]
fn slices_of_a_constant_volume_absorb_by_its_length() {
    for camera in CAMERAS {
        let stage = constant("slices", camera, r#"{ "step": 0.7 }"#);
        for backend in adapters() {
            for format in formats(&backend) {
                for (classify, steps) in [("post", "1"), ("preintegrated_2d", "4")] {
                    let sets = [
                        format!("image.format={format}"),
                        format!("image.slots.classify={classify}"),
                        format!("image.steps_per_pass={steps}"),
                    ];
                    let sets = sets.each_ref().map(String::as_str);
                    let error = worst_opacity(&stage, &backend, &sets);
                    let slabs = if steps == "1" { 22.0 } else { 6.0 };
                    let bound = match format {
                        "rgba32float" => 1e-4,
                        "rgba16float" => slabs / 4096.0,
                        _ => slabs / 510.0,
                    };
                    assert!(error <= bound, "{backend} {camera} {sets:?}: {error}");
                }
            }
        }
    }
}

#[test]
fn multipass_rays_of_a_constant_volume_absorb_by_its_length() {
    for camera in CAMERAS {
        let params = r#"{ "step": 0.7, "early_termination": 0.0, "steps_per_pass": 3 }"#;
        let stage = constant("multipass_raycast", camera, params);
        for backend in adapters() {
            let error = worst_opacity(&stage, &backend, &[]);
            assert!(error <= 1e-4, "{backend} {camera}: {error}");
        }
    }
}

/// Where planes across the view are the raycast's whole steps, slabs are its segments.
#[test]
fn slices_along_an_axis_are_the_raycast() {
    let camera = "orbit(azimuth: 90, elevation: 0, projection: orthographic)";
    let step = r#"{ "step": 0.77 }"#;
    for (classify, steps) in [
        ("post", "4"),
        ("preintegrated_2d", "1"),
        ("second_order", "4"),
    ] {
        let slots = format!(r#"{{ "classify": "{classify}" }}"#);
        let [slices, rays] = ["slices", "raycast"].map(|kind| waves(kind, camera, &slots, step));
        for backend in adapters() {
            if !formats(&backend).contains(&"rgba32float") {
                continue;
            }
            let sets = [
                "image.format=rgba32float",
                &format!("image.steps_per_pass={steps}"),
            ];
            let drawn = render(&slices, &sets, &backend, SIZE).0;
            let cast = render(&rays, &["image.early_termination=0"], &backend, SIZE).0;
            let error = largest(&drawn, &cast);
            // A sample that is rounded otherwise may take the next of 8192 entries.
            let bound = if classify == "post" { 1e-4 } else { 1e-5 };
            assert!(error <= bound, "{backend} {classify}: {error}");
        }
    }
}

/// Slabs are cut where the clip shape is, whatever the planes are: errors fall with the square of the step.
#[test]
fn slices_converge_to_the_reference_where_they_are_cut() {
    let slots = r#"{ "clip": "planes", "classify": "preintegrated_2d" }"#;
    let params = r#"{ "plane_1": [1, 0.3, 0.5, 0.1], "format": "rgba32float" }"#;
    let stage = waves("slices", CAMERAS[0], slots, params);
    let (truth, _) = truth(&stage, &[], SIZE);
    let truth = truth.picture().unwrap();
    for backend in adapters() {
        if !formats(&backend).contains(&"rgba32float") {
            continue;
        }
        let error = |step: &str| {
            let sets = [format!("image.step={step}")];
            let picture = render(&stage, &[&sets[0]], &backend, SIZE).0;
            compare_without_flip(&picture, &truth).unwrap().rmse
        };
        let [coarse, fine] = ["0.4", "0.1"].map(error);
        assert!(fine <= 2e-4, "{backend}: {fine}");
        assert!(coarse / fine >= 10.0, "{backend}: {coarse} {fine}");
    }
}

/// However many segments a pass has and whenever rays are taken off the list.
#[test]
fn multipass_rays_are_the_raycast() {
    for (camera, classify) in
        CAMERAS
            .into_iter()
            .zip(["post", "preintegrated_2d", "simpson", "second_order"])
    {
        let slots = format!(r#"{{ "classify": "{classify}" }}"#);
        let params = r#"{ "step": 0.3, "early_termination": 0.05 }"#;
        let passes = waves("multipass_raycast", camera, &slots, params);
        // In pairs of segments rays would end a segment later.
        let slots = format!(r#"{{ "classify": "{classify}", "walk": "segments" }}"#);
        let rays = waves("raycast", camera, &slots, params);
        for backend in adapters() {
            let cast = render(&rays, &[], &backend, SIZE).0;
            for (steps, termination) in [(1, 1), (4, 4), (7, 3)] {
                let sets = [
                    format!("image.steps_per_pass={steps}"),
                    format!("image.passes_per_termination={termination}"),
                ];
                let sets = sets.each_ref().map(String::as_str);
                let drawn = render(&passes, &sets, &backend, SIZE).0;
                let error = largest(&drawn, &cast);
                assert!(error <= 1e-5, "{backend} {camera} {sets:?}: {error}");
            }
        }
    }
}

fn refused(stage: &Stage, sets: &[&str]) -> Findings {
    let backend = &adapters()[0];
    let opened = stage.open("graph.ron", sets, backend, [16, 16]);
    opened
        .err()
        .unwrap_or_else(|| panic!("{sets:?} is not refused"))
}

#[test]
fn what_they_do_not_cover_is_refused() {
    let slices = waves("slices", CAMERAS[0], r#"{ "clip": "planes" }"#, "{}");
    let naive = refused(&slices, &["image.clip_method=naive"]).to_string();
    assert!(
        naive.contains("clip_method") && naive.contains("accurate"),
        "{naive}"
    );
    let lit = refused(&slices, &["image.slots.light=phong"]).to_string();
    assert!(lit.contains("light"), "{lit}");
    let passes = waves("multipass_raycast", CAMERAS[0], "{}", r#"{ "step": 0.01 }"#);
    let clipped = refused(&passes, &["image.slots.clip=planes"]).to_string();
    assert!(clipped.contains("clip"), "{clipped}");
}
