//! The isosurface of another volume.

use glam::DVec3;
use volgraph_tests::{Stage, adapters, graph, render};

use super::{
    ALONG_Y, CUBIC, Case, INSIDE, Line, PERSPECTIVE, STRETCHED, TABLE, Truth, above, check, length,
    planes, scene,
};

/// A ramp along a direction, as a clip volume of its own size and placement: (source, stage, parameters, truth).
fn ramp(direction: DVec3, level: f64, is_inside: bool) -> (String, Truth) {
    let keep = if is_inside { "inside" } else { "outside" };
    let params = format!(
        r#", "clip_isovalue": {level}, "clip_isovalue_unit": "data", "clip_keep": "{keep}""#
    );
    let truth = move |line: Line, whole: (f64, f64)| {
        let inside = length(above(whole, line, direction, level));
        if is_inside {
            inside
        } else {
            length(whole) - inside
        }
    };
    (params, Box::new(truth))
}

#[test]
fn a_clip_volume_cuts_at_its_isosurface_whatever_its_size_and_placement() {
    // Larger than the block: the field is linear everywhere in it, and a cut is where the ramp says.
    let direction = DVec3::new(0.5, 0.25, -0.125);
    let large = |stage: Stage| {
        stage.with_floats("c", [6, 9, 4], move |x, y, z| {
            let world = DVec3::new(
                f64::from(x) * 4.0 - 4.0,
                f64::from(y) * 3.0 - 4.0,
                f64::from(z) * 11.0 - 7.0,
            );
            direction.dot(world) as f32
        })
    };
    let large_source = r#"path: "c_6x9x4_float32.raw", spacing: (4, 3, 11), origin: (-4, -4, -7)"#;
    // Smaller than the block: around it, it goes on with its nearest value, here along x alone.
    let small = |stage: Stage| stage.with_floats("c", [5, 1, 2], |x, _, _| x as f32 * 0.25 + 2.0);
    let small_source =
        r#"path: "c_5x1x2_float32.raw", spacing: (0.25, 0.5, 0.25), origin: (2, 3, 1)"#;
    let cases = [
        (
            "large",
            &CUBIC,
            PERSPECTIVE,
            true,
            TABLE,
            0.3,
            ramp(direction, 1.1, true),
        ),
        (
            "large",
            &STRETCHED,
            PERSPECTIVE,
            true,
            "",
            4.0,
            ramp(direction, 1.1, false),
        ),
        (
            "large",
            &STRETCHED,
            ALONG_Y,
            true,
            TABLE,
            16.0,
            ramp(direction, 2.0, true),
        ),
        (
            "large",
            &CUBIC,
            INSIDE,
            true,
            "",
            1.0,
            ramp(direction, 1.1, false),
        ),
        (
            "small",
            &CUBIC,
            PERSPECTIVE,
            false,
            "",
            1.0,
            ramp(DVec3::X, 2.6, true),
        ),
        (
            "small",
            &STRETCHED,
            PERSPECTIVE,
            false,
            TABLE,
            4.0,
            ramp(DVec3::X, 2.6, false),
        ),
    ];
    for (name, block, camera, is_large, slots, step, shape) in cases {
        let case = Case {
            name,
            block,
            camera,
            clip: "volume",
            slots,
            step,
            shape,
        };
        if is_large {
            check(&case, large, large_source, 20);
        } else {
            check(&case, small, small_source, 20);
        }
    }
}

#[test]
fn a_clip_volume_laid_over_the_box_has_no_place_of_its_own() {
    // Half of its length is half of the box's.
    let (params, _) = ramp(DVec3::X, 1.5, true);
    let shape = planes(&STRETCHED, &[[1.0, 0.0, 0.0, 0.0]], true);
    let case = Case {
        name: "laid over",
        block: &STRETCHED,
        camera: PERSPECTIVE,
        clip: "volume",
        slots: TABLE,
        step: 1.0,
        shape: (format!(r#"{params}, "clip_volume_place": "box""#), shape.1),
    };
    let clip = |stage: Stage| stage.with_floats("c", [4, 3, 2], |x, _, _| x as f32);
    check(
        &case,
        clip,
        r#"path: "c_4x3x2_float32.raw", origin: (300, 0, 0)"#,
        20,
    );
}

#[test]
fn a_clip_volume_changes_neither_the_camera_nor_what_it_does_not_cut() {
    let clip = r#"path: "c_2x2x2_float32.raw", origin: (300, 0, 0)"#;
    let params =
        r#"{ "step": 2.0, "clip_step": 0.1, "clip_isovalue": 0.5, "clip_isovalue_unit": "data" }"#;
    // Of such a field, each place where a segment ends makes a difference.
    let rough = |x: u32, y: u32, z: u32| ((x * 3 + y * 5 + z * 7) % 8) as f32;
    let transfer = "(points: [(at: 0, color: (1, 0, 0), opacity: 0), (at: 1, color: (0, 1, 0), opacity: 0.4)])";
    let with = |slots: &str, clip: &str| {
        scene(&CUBIC, PERSPECTIVE, slots, params, clip)
            .with_floats("c", [2; 3], |_, _, _| 1.0)
            .with_floats("v", [8, 6, 4], rough)
            .with("transfer.ron", transfer)
    };
    let cut = with(r#"{ "clip": "volume" }"#, clip);
    let plain = Stage::new()
        .with_floats("v", [8, 6, 4], rough)
        .with("transfer.ron", transfer)
        .with(
            "graph.ron",
            graph(CUBIC.source, PERSPECTIVE, "{}", "{}", r#"{ "step": 2.0 }"#),
        );
    for backend in adapters() {
        let (cut, cut_view) = render(&cut, &[], &backend, [40, 32]);
        let (plain, plain_view) = render(&plain, &[], &backend, [40, 32]);
        assert_eq!(cut_view, plain_view, "the camera fits what rays start from");
        let worst = volgraph_measure::compare_without_flip(&cut, &plain)
            .unwrap()
            .max;
        println!("{backend}: {worst:?}");
        // A part that goes on is 1e-4 voxels shorter than whole steps: after five of them segments are 5e-4 voxels off,
        // and a voxel changes the opacity of a segment by at most 0.4.
        assert!(worst.error < 2e-4, "{backend}: {worst:?}");
    }
}

#[test]
fn a_clip_volume_that_is_missing_or_asked_for_too_often_is_refused() {
    let refused = |slots: &str, params: &str, clip: &str| {
        let stage =
            scene(&CUBIC, PERSPECTIVE, slots, params, clip).with_floats("c", [2; 3], |_, _, _| 1.0);
        let findings = stage
            .open("graph.ron", &[], &adapters()[0], [8, 8])
            .err()
            .unwrap();
        findings
            .into_iter()
            .map(|finding| (finding.code, finding.message))
            .collect::<Vec<_>>()
    };
    let slots = r#"{ "clip": "volume" }"#;
    let missing = refused(slots, "{}", "");
    assert!(
        missing
            .iter()
            .any(|(code, message)| *code == "missing-input" && message.contains("`clip_volume`")),
        "{missing:?}"
    );
    let tiny = r#"path: "c_2x2x2_float32.raw", spacing: (1, 1, 0.001)"#;
    let often = refused(slots, r#"{ "clip_step": 0.1 }"#, tiny);
    assert!(
        often.iter().any(|(code, _)| *code == "too-many-segments"),
        "{often:?}"
    );
}
