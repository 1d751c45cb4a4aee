//! The limit `fetch_only`: the sum of its samples in closed form, in both stages.

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_tests::{STAGES, Stage, adapters, box_interval, ray, render};

const STEP: f64 = 0.6;
const GAIN: f64 = 0.01;

/// The last two look along z, in which the ramp is constant.
const CAMERAS: [&str; 4] = [
    "orbit(azimuth: 33, elevation: 21)",
    "orbit(azimuth: 33, elevation: 21, projection: orthographic)",
    "look_at(eye: (4, 3, 30), target: (4, 3, 0), projection: orthographic)",
    "look_at(eye: (4, 3, 30), target: (4, 3, 0), fov_y: 20)",
];

fn scene(volume: &str, camera: &str) -> String {
    format!(
        r#"(
    sources: {{ "volume": volume(path: "{volume}", node_centred: true) }},
    camera: {camera},
    nodes: {{
        "box": (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "fetch_only", in: {{ "volume": "volume", "rays": "box" }},
                  params: {{ "step": {STEP}, "gain": {GAIN} }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    )
}

/// The largest difference of the grey from the sum over a ray of a scalar that is linear in space, and how many rays met
/// the box. Where a rounding decides whether there is one sample more, nothing is said.
fn worst((picture, view): &(Picture, View), scalar: impl Fn(DVec3) -> f64) -> (f64, usize) {
    let span = (DVec3::ZERO, DVec3::new(8.0, 6.0, 7.0));
    let (mut worst, mut met) = (0.0_f64, 0);
    for y in 0..picture.height {
        for x in 0..picture.width {
            let (origin, direction) = ray(view, x, y);
            let at = |distance: f64| scalar(origin + distance * direction);
            let mut sum = 0.0;
            if let Some((near, far)) = box_interval((origin, direction), span.0, span.1) {
                let steps = (far - near) / STEP;
                if (steps - steps.round()).abs() < 1e-3 {
                    continue;
                }
                met += 1;
                let count = steps.ceil();
                sum = 0.5 * count * (at(near) + at(near + (count - 1.0) * STEP)) + at(far);
            }
            let [grey, _, blue, alpha] = picture.color[(y * picture.width + x) as usize];
            assert_eq!((grey, 1.0), (blue, alpha));
            worst = worst.max((f64::from(grey) - GAIN * STEP * sum).abs());
        }
    }
    (worst, met)
}

#[test]
fn the_sum_of_a_linear_volume_is_in_closed_form() {
    for camera in CAMERAS {
        let stage = Stage::new()
            .with_floats("v", [9, 7, 8], |x, _, _| 2.0 + x as f32 / 8.0)
            .with("graph.ron", scene("v_9x7x8_float32.raw", camera));
        for backend in adapters() {
            for form in STAGES {
                let set = format!("image.stage={form}");
                let drawn = render(&stage, &[&set], &backend, [40, 32]);
                // Some 17 samples of 0.006 each, filtered with at least 8 bits between neighbours 1/8 apart.
                let (error, met) = worst(&drawn, |at| at.x / 8.0);
                assert!(error <= 1e-4, "{backend} {form} {camera}: {error}");
                assert!(met > 100, "{camera} shows nothing");
                // The check itself must see a sum that is a hundredth off.
                assert!(worst(&drawn, |at| 1.01 * at.x / 8.0).0 > 1e-4);
            }
        }
    }
}

#[test]
fn a_volume_of_one_value_is_the_low_end_of_its_range() {
    let stage = Stage::new()
        .with_floats("v", [9, 7, 8], |_, _, _| 3.0)
        .with("graph.ron", scene("v_9x7x8_float32.raw", CAMERAS[0]));
    for backend in adapters() {
        let (error, met) = worst(&render(&stage, &[], &backend, [32, 32]), |_| 0.0);
        assert!(error <= 1e-5 && met > 100, "{backend}: {error}");
    }
}

#[test]
fn one_sample_of_each_ray_is_the_one_at_its_exit() {
    let stage = Stage::new()
        .with_floats("v", [9, 7, 8], |x, _, _| 2.0 + x as f32 / 8.0)
        .with("graph.ron", scene("v_9x7x8_float32.raw", CAMERAS[0]));
    let drawn = render(&stage, &["image.samples=0"], &adapters()[0], [32, 32]);
    let (picture, view) = &drawn;
    let span = (DVec3::ZERO, DVec3::new(8.0, 6.0, 7.0));
    let mut met = 0;
    for y in 0..picture.height {
        for x in 0..picture.width {
            let (origin, direction) = ray(view, x, y);
            if let Some((near, far)) = box_interval((origin, direction), span.0, span.1)
                && far - near > 1e-3
            {
                met += 1;
                let expected = GAIN * STEP * (origin + far * direction).x / 8.0;
                let [grey, ..] = picture.color[(y * picture.width + x) as usize];
                assert!(
                    (f64::from(grey) - expected).abs() <= 1e-5,
                    "{grey} {expected}"
                );
            }
        }
    }
    assert!(met > 100);
}
