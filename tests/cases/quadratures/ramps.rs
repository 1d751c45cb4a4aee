//! Quadratures where the scalar along a ray is known: peaks, short segments, sharp bends, scalars that are close.

use glam::DVec3;
use volgraph_optics::TransferFunction;
use volgraph_tests::repository::choices;
use volgraph_tests::{Stage, adapters};

use super::{along, draw, parse, pixels, stage, worst};

/// Looks along x, so that all rays are almost as long.
const ALONG_X: &str = "look_at(eye: (-40, 3, 3.5), target: (4, 3, 3.5), fov_y: 6)";

/// A volume of 8 voxels along x in which the scalar goes evenly from `from` to `to`.
fn ramp(from: f64, to: f64, transfer: &str) -> Stage {
    let value = move |x: u32, _, _| (from + (to - from) * f64::from(x) / 8.0) as f32;
    stage(
        r#"path: "v_9x7x8_float32.raw", node_centred: true"#,
        ALONG_X,
        transfer,
        "",
    )
    .with_floats("v", [9, 7, 8], value)
}

const RAMP_SPAN: (DVec3, DVec3) = (DVec3::ZERO, DVec3::new(8.0, 6.0, 7.0));

/// Pixels of a picture of a ramp from 0 to 1, and the truth.
fn ramp_pixels(
    scene: &Stage,
    transfer: &TransferFunction,
    backend: &str,
    choice: &str,
    step: f64,
) -> Vec<([f64; 4], [f64; 4])> {
    let drawn = draw(scene, backend, "compute", choice, step, [20, 20]);
    pixels(&drawn, RAMP_SPAN, 7.0, |from, to| {
        along(transfer, from.distance(to), 4000, |w| {
            (from.x + w * (to.x - from.x)) / 8.0
        })
    })
}

#[test]
fn pre_integration_of_any_kind_is_right_across_narrow_peaks_and_points_are_not() {
    // Peaks of a sixth of a voxel; segments of 2.5 voxels, the last one of half a voxel.
    let text = "(domain: data(from: 0, to: 1), color: [(0.3, (1, 0, 0)), (0.6, (0, 1, 0.3))],
        extinction: [(0.34, 0), (0.35, 8), (0.36, 0), (0.72, 0), (0.73, 12), (0.74, 0)])";
    let (scene, transfer) = (ramp(0.0, 1.0, text), parse(text));
    for backend in adapters() {
        for choice in &choices("classify") {
            let found = ramp_pixels(&scene, &transfer, &backend, choice, 2.5);
            let (error, of_opacity) = (worst(&found), worst_of_opacity(&found));
            println!("{backend} {choice}: {error:.2e} {of_opacity:.2e}");
            match choice.as_str() {
                // Colours of tables are right to 1e-5 of each segment.
                "preintegrated_2d" | "preintegrated_3d" | "second_order" => {
                    assert!(error <= 5e-5, "{backend} {choice}: {error}");
                }
                // The order of colours inside of a segment does not count.
                "integral_1d" => assert!(
                    of_opacity <= 1e-5 && error <= 1e-2,
                    "{backend}: {of_opacity} {error}"
                ),
                _ => assert!(
                    error > 0.5,
                    "{backend} {choice} must miss the peaks: {error}"
                ),
            }
        }
    }
}

#[test]
fn the_last_short_segment_is_right_to_a_higher_order() {
    let text =
        "(domain: data, color: [(0, (1, 0, 0)), (1, (0, 1, 1))], extinction: [(0, 0.2), (1, 0.7)])";
    let (scene, transfer) = (ramp(0.0, 1.0, text), parse(text));
    for backend in adapters() {
        for step in [3.0, 5.0] {
            let error = |choice| worst(&ramp_pixels(&scene, &transfer, &backend, choice, step));
            let [whole, found] = ["preintegrated_2d", "second_order"].map(error);
            println!("{backend} {step}: {whole:.2e} {found:.2e}");
            // Tables are right to 1e-5; the last segment's error is of the fifth order in its depth, which is 2 at most.
            // That of `preintegrated_2d` is of the third.
            assert!(found <= 2e-5, "{backend} {step}: {found}");
            assert!(whole > 10.0 * found, "{backend} {step}: {whole} {found}");
        }
    }
}

#[test]
fn a_bend_that_tells_nothing_is_not_trusted() {
    // A segment from 0 to 0.1 by way of 1, and a peak in between: the straight run is ten times as long in it as the bent
    // one. Without the rule its depth would be negative, and nothing of it drawn.
    let text = "(domain: data(from: 0, to: 1), color: (1, 0.5, 0),
        extinction: [(0.04, 0), (0.05, 3), (0.06, 0)])";
    let transfer = parse(text);
    let value = |x: f64| {
        let w = x / 8.0;
        0.1 * w + 3.8 * w * (1.0 - w)
    };
    let scene =
        ramp(0.0, 1.0, text).with_floats("v", [9, 7, 8], |x, _, _| value(f64::from(x)) as f32);
    let truth = |from: DVec3, to: DVec3| {
        along(&transfer, from.distance(to), 4000, |w| {
            let x = from.x + w * (to.x - from.x);
            let cell = x.floor().clamp(0.0, 7.0);
            value(cell) + (x - cell) * (value(cell + 1.0) - value(cell))
        })
    };
    for backend in adapters() {
        let error = |choice| {
            let drawn = draw(&scene, &backend, "compute", choice, 16.0, [20, 20]);
            let found = pixels(&drawn, RAMP_SPAN, 7.0, truth);
            let is_inside = |seen: &[f64; 4]| seen.iter().all(|value| (0.0..=1.0).contains(value));
            assert!(
                found.iter().all(|(seen, _)| is_inside(seen)),
                "{backend} {choice}: {:?}",
                found[0]
            );
            // The segment is seen at all.
            assert!(
                found.iter().all(|(seen, _)| seen[3] > 0.05),
                "{backend} {choice}"
            );
            worst(&found)
        };
        let [straight, found] = ["preintegrated_2d", "second_order"].map(error);
        println!("{backend}: {straight:.2e} {found:.2e}");
        assert!(found < 0.2 * straight, "{backend}: {straight} {found}");
    }
}

#[test]
fn means_of_close_scalars_do_not_cancel() {
    // Far more integral in front of the scalars than between them.
    let text = "(domain: data(from: 0, to: 1), color: (1, 1, 1),
        extinction: [(0, 16), (0.5, 16), (0.51, 0.1), (1, 0.4)])";
    for span in [1e-4, 3e-3, 2e-2] {
        let scene = ramp(0.9, 0.9 + span, text);
        for backend in adapters() {
            let drawn = draw(&scene, &backend, "compute", "integral_1d", 1.0, [24, 24]);
            let truth = |from: DVec3, to: DVec3| {
                let mean = 0.9 + span * 0.5 * (from.x + to.x) / 8.0;
                let extinction = 0.1 + 0.3 * (mean - 0.51) / 0.49;
                [1.0 - (-extinction * from.distance(to)).exp(); 4]
            };
            let error = worst(&pixels(&drawn, RAMP_SPAN, 7.0, truth));
            println!("{backend} {span}: {error:.2e}");
            // Some roundings of f32. Of sums in one float each, means would be off by up to a hundredth.
            assert!(error <= 2e-6, "{backend} {span}: {error}");
        }
    }
}

fn worst_of_opacity(pixels: &[([f64; 4], [f64; 4])]) -> f64 {
    let errors = pixels
        .iter()
        .map(|(seen, truth)| (seen[3] - truth[3]).abs());
    errors.fold(0.0, f64::max)
}
