//! Pictures against closed forms, on every backend, stage and classification.

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

const CAMERAS: [&str; 4] = [
    "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
    "orbit(azimuth: 33, elevation: 21, projection: orthographic)",
    // Inside of the volume, and one that looks along a face.
    "look_at(eye: (3.2, 2.1, 4.4), target: (0.0, 1.0, 0.0), fov_y: 70)",
    "look_at(eye: (3.5, -20.0, 3.5), target: (3.5, 0.0, 3.5), fov_y: 30)",
];

/// The largest error of the opacity over all pixels, and the number of pixels whose ray meets the box.
fn worst(
    (picture, view): &(Picture, View),
    (low, high): (DVec3, DVec3),
    truth: impl Fn(DVec3, DVec3) -> f64,
) -> (f64, usize) {
    let opacity = picture.opacity.as_ref().unwrap();
    let (mut worst, mut met) = (0.0_f64, 0);
    for y in 0..picture.height {
        for x in 0..picture.width {
            let ray = ray(view, x, y);
            let expected = match box_interval(ray, low, high) {
                Some((near, far)) => {
                    met += 1;
                    truth(ray.0 + ray.1 * near, ray.0 + ray.1 * far)
                }
                None => 0.0,
            };
            worst =
                worst.max((f64::from(opacity[(y * picture.width + x) as usize]) - expected).abs());
        }
    }
    (worst, met)
}

#[test]
fn a_constant_volume_absorbs_by_its_length() {
    let slots = ["{}", r#"{ "classify": "preintegrated_2d" }"#];
    for camera in CAMERAS {
        for slots in slots {
            let stage = Stage::new()
                .with_floats("v", [8, 8, 8], |_, _, _| 0.5)
                .with(
                    "transfer.ron",
                    "(points: [(at: 0.5, color: (1, 0.5, 0.2), opacity: 0.1)])",
                )
                .with(
                    "graph.ron",
                    graph(
                        r#"path: "v_8x8x8_float32.raw""#,
                        camera,
                        "{}",
                        slots,
                        r#"{ "step": 0.7, "early_termination": 0.0 }"#,
                    ),
                );
            let extinction = -(0.9_f64.ln());
            for backend in adapters() {
                for form in STAGES {
                    let set = format!("image.stage={form}");
                    let span = (DVec3::splat(-0.5), DVec3::splat(7.5));
                    let truth =
                        |from: DVec3, to: DVec3| 1.0 - (-extinction * from.distance(to)).exp();
                    let drawn = render(&stage, &[&set], &backend, [48, 40]);
                    let (error, met) = worst(&drawn, span, truth);
                    assert!(error <= 1e-4, "{backend} {form} {camera} {slots}: {error}");
                    assert!(met > 100, "{camera} shows nothing");
                    // The check itself must see a volume that is a hundredth off.
                    let off = |from: DVec3, to: DVec3| {
                        1.0 - (-1.01 * extinction * from.distance(to)).exp()
                    };
                    assert!(worst(&drawn, span, off).0 > 1e-4);
                }
            }
        }
    }
}

#[test]
fn a_linear_ramp_of_extinction_has_its_closed_form() {
    // Centre to centre the field is linear all the way; its integral is the mean of the ends times the length.
    let slots = ["{}", r#"{ "classify": "preintegrated_2d" }"#];
    for slots in slots {
        let stage = Stage::new()
            .with_floats("v", [9, 7, 8], |x, _, _| x as f32 / 8.0)
            .with(
                "transfer.ron",
                "(domain: data, color: (1, 1, 1), extinction: [(0.0, 0.0), (1.0, 0.4)])",
            )
            .with(
                "graph.ron",
                graph(
                    r#"path: "v_9x7x8_float32.raw", node_centred: true"#,
                    "orbit(azimuth: 40, elevation: 30)",
                    "{}",
                    slots,
                    r#"{ "early_termination": 0.0 }"#,
                ),
            );
        for backend in adapters() {
            for form in STAGES {
                let set = format!("image.stage={form}");
                let span = (DVec3::ZERO, DVec3::new(8.0, 6.0, 7.0));
                let truth = |from: DVec3, to: DVec3| {
                    let mean = 0.4 * 0.5 * (from.x + to.x) / 8.0;
                    1.0 - (-mean * from.distance(to)).exp()
                };
                let (error, met) = worst(&render(&stage, &[&set], &backend, [48, 40]), span, truth);
                assert!(error <= 1e-4, "{backend} {form} {slots}: {error}");
                assert!(met > 100);
            }
        }
    }
}

#[test]
fn the_depth_is_where_half_of_the_light_is_gone() {
    let stage = Stage::new()
        .with_floats("v", [8, 8, 8], |_, _, _| 0.5)
        .with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (1, 1, 1), opacity: 0.3)])",
        )
        .with(
            "graph.ron",
            graph(
                r#"path: "v_8x8x8_float32.raw""#,
                CAMERAS[0],
                "{}",
                "{}",
                r#"{ "step": 0.7 }"#,
            ),
        );
    let half = 2.0_f64.ln() / -(0.7_f64.ln());
    for backend in adapters() {
        let (picture, view) = render(&stage, &[], &backend, [40, 40]);
        let depth = picture.depth.unwrap();
        for y in 0..40 {
            for x in 0..40 {
                let seen = f64::from(depth[(y * 40 + x) as usize]);
                let interval =
                    box_interval(ray(&view, x, y), DVec3::splat(-0.5), DVec3::splat(7.5));
                match interval.filter(|(near, far)| far - near > half + 1e-3) {
                    Some((near, _)) => {
                        assert!((seen - near - half).abs() < 2e-3, "{backend} {seen} {near}");
                    }
                    None if interval.is_none_or(|(near, far)| far - near < half - 1e-3) => {
                        assert_eq!(seen, f64::INFINITY, "{backend} {x} {y} {interval:?}");
                    }
                    None => {}
                }
            }
        }
    }
}

#[test]
fn a_volume_of_nothing_shows_the_background_as_it_is() {
    // The same function of the ray inside and outside of the box's outline: no seam, not even of one code.
    for (camera, pattern) in [
        (CAMERAS[0], "checker"),
        (CAMERAS[1], "gradient"),
        (CAMERAS[2], "checker"),
    ] {
        let stage = Stage::new()
            .with_floats("v", [8, 8, 8], |x, y, z| (x + y + z) as f32)
            .with(
                "transfer.ron",
                "(points: [(at: 0, color: (1, 0, 0), opacity: 0)])",
            )
            .with(
                "graph.ron",
                graph(
                    r#"path: "v_8x8x8_float32.raw""#,
                    camera,
                    &format!(r#"{{ "pattern": "{pattern}" }}"#),
                    r#"{ "light": "phong" }"#,
                    "{}",
                )
                .replace(
                    r#""color": "image.color""#,
                    r#""color": "image.color", "alone": "background.color""#,
                ),
            );
        for backend in adapters() {
            for form in STAGES {
                let set = format!("image.stage={form}");
                let mut session = stage
                    .open("graph.ron", &[&set], &backend, [64, 48])
                    .unwrap();
                let (picture, _) = session.render().unwrap();
                let alone = session.read("alone").unwrap();
                let is_same = picture.color == alone.color;
                assert!(
                    is_same,
                    "{backend} {form} {camera}: the background has a seam"
                );
                assert!(
                    alone.color.iter().any(|pixel| pixel != &alone.color[0]),
                    "the pattern is flat"
                );
            }
        }
    }
}

#[test]
fn voxels_that_are_not_numbers_leave_the_picture_finite() {
    let values = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 1.0];
    let stage = Stage::new()
        .with_floats("v", [6, 6, 6], |x, y, z| values[((x * 7 + y * 3 + z) % 5) as usize])
        .with("transfer.ron", "(domain: data, points: [(at: 0, color: (1, 0, 0), opacity: 0), (at: 1, color: (0, 1, 0), opacity: 0.5)])")
        .with("graph.ron", graph(r#"path: "v_6x6x6_float32.raw""#, CAMERAS[0], "{}", r#"{ "light": "phong" }"#, "{}"));
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, [32, 32]).unwrap();
        let (picture, _) = session.render().unwrap();
        assert!(
            picture
                .color
                .iter()
                .flatten()
                .all(|value| value.is_finite()),
            "{backend}"
        );
        assert!(
            picture.color.iter().any(|pixel| pixel[1] > 0.1),
            "{backend}: what is a number is still drawn"
        );
        let warnings = session.scene().warnings();
        assert!(
            warnings
                .iter()
                .any(|(_, warning)| warning.contains("not numbers")),
            "{warnings:?}"
        );
    }
}

#[test]
fn one_voxel_thick_volumes_are_drawn() {
    for dims in [[1, 8, 8], [8, 1, 8], [8, 8, 1], [1, 1, 1]] {
        let name = format!("v_{}x{}x{}_float32.raw", dims[0], dims[1], dims[2]);
        let stage = Stage::new()
            .with_floats("v", dims, |_, _, _| 0.5)
            .with(
                "transfer.ron",
                "(points: [(at: 0.5, color: (1, 1, 1), opacity: 0.5)])",
            )
            .with(
                "graph.ron",
                graph(
                    &format!(r#"path: "{name}""#),
                    CAMERAS[0],
                    "{}",
                    r#"{ "light": "phong" }"#,
                    "{}",
                ),
            );
        let high = DVec3::from_array(dims.map(f64::from)) - 0.5;
        for backend in adapters() {
            let truth = |from: DVec3, to: DVec3| 1.0 - 0.5_f64.powf(from.distance(to));
            let sets = ["image.early_termination=0"];
            let drawn = render(&stage, &sets, &backend, [48, 40]);
            let (error, met) = worst(&drawn, (DVec3::splat(-0.5), high), truth);
            assert!(
                error < 1e-4 && met > 20,
                "{backend} {dims:?}: {error} over {met} pixels"
            );
        }
    }
}

#[test]
fn far_from_the_origin_of_the_world_and_of_the_scalars_the_picture_is_the_same() {
    let volume = |name: &str, offset: f64| {
        let mut bytes = b"NRRD0004\ntype: double\ndimension: 3\nsizes: 6 6 6\nencoding: raw\nendian: little\n\n".to_vec();
        for i in 0..216_u32 {
            bytes.extend((offset + f64::from(i * 37 % 101)).to_le_bytes());
        }
        (name.to_owned(), bytes)
    };
    let transfer = |offset: f64| {
        let (low, high) = (offset + 20.0, offset + 100.0);
        format!(
            "(domain: data, points: [(at: {low:?}, color: (1, 0, 0), opacity: 0), (at: {high:?}, color: (0, 1, 0), opacity: 0.5)])"
        )
    };
    let slots = r#"{ "light": "phong" }"#;
    let at = |volume: &str, origin: &str| {
        graph(
            &format!(r#"path: "{volume}", spacing: (0.01, 0.01, 0.01), origin: {origin}"#),
            CAMERAS[0],
            "{}",
            slots,
            "{}",
        )
    };
    let scene = |offset: f64, origin: &str| {
        let (name, bytes) = volume("v.nrrd", offset);
        Stage::new()
            .with(&name, bytes)
            .with("transfer.ron", transfer(offset))
            .with("graph.ron", at(&name, origin))
    };
    for backend in adapters() {
        for form in STAGES {
            let set = format!("image.stage={form}");
            let picture = |stage: &Stage| render(stage, &[&set], &backend, [40, 40]).0;
            let here = picture(&scene(0.0, "(0, 0, 0)"));
            let far = picture(&scene(0.0, "(500000, 4000000, 100)"));
            let shifted = picture(&scene(1e6, "(0, 0, 0)"));
            for (what, other) in [("placement", &far), ("scalars", &shifted)] {
                let worst = volgraph_measure::compare_without_flip(&here, other)
                    .unwrap()
                    .max;
                assert!(worst.error < 1e-4, "{what} on {backend} {form}: {worst:?}");
            }
            assert!(
                here.color.iter().any(|pixel| pixel[1] > 0.05),
                "nothing is seen"
            );
        }
    }
}

#[test]
fn more_segments_than_are_walked_are_refused_and_the_longest_walk_is_whole() {
    let stage = |spacing: &str| {
        let volume = format!(r#"path: "v_8x8x8_float32.raw", spacing: {spacing}"#);
        let camera = "look_at(eye: (0.0035, -20, 3.5), target: (0.0035, 0, 3.5), projection: orthographic, height: 0.001)";
        Stage::new()
            .with_floats("v", [8, 8, 8], |_, _, _| 0.5)
            .with("transfer.ron", "(reference_length: (world: 1), points: [(at: 0.5, color: (1, 1, 1), opacity: 0.1)])")
            .with("graph.ron", graph(&volume, camera, "{}", "{}", r#"{ "step": 0.4, "early_termination": 0.0 }"#))
    };
    for backend in adapters() {
        let refused = stage("(0.0001, 1, 1)")
            .open("graph.ron", &[], &backend, [4, 4])
            .err()
            .unwrap();
        assert!(
            refused
                .into_iter()
                .all(|finding| finding.code == "too-many-segments")
        );
        for form in STAGES {
            let set = format!("image.stage={form}");
            let (picture, _) = render(&stage("(0.001, 1, 1)"), &[&set], &backend, [4, 4]);
            // 20,000 segments, and as many roundings of the transmittance.
            let expected = 1.0 - 0.9_f64.powi(8);
            let seen = f64::from(picture.opacity.unwrap()[5]);
            assert!(
                (seen - expected).abs() < 2e-3,
                "{backend} {form}: {seen}, not {expected}"
            );
        }
    }
}
