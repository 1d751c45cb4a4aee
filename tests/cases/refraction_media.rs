//! Rays through media whose index changes continuously, against paths that are known.

use std::f64::consts::PI;

use glam::DVec3;
use volgraph_tests::{STAGES, Stage, adapters, graph, render};

use crate::glass::Beyond;
use crate::refraction::{PLACES, stage, worst};

/// Exit place, y, of a ray through layers of index n(u), u = z / depth, from the top face to the bottom one: n sin a is
/// kept, and the way aside is the integral of tan a.
fn through_layers(
    (origin, direction): (DVec3, DVec3),
    depth: f64,
    index: impl Fn(f64) -> f64,
) -> (DVec3, DVec3) {
    let down = -direction.z;
    let enters = origin + direction * ((origin.z - depth) / down);
    let kept = index(1.0) * (1.0 - down * down).sqrt();
    let steps = 4000;
    let aside: f64 = (0..steps)
        .map(|i| {
            let n = index((f64::from(i) + 0.5) / f64::from(steps));
            kept / (n * n - kept * kept).sqrt() * depth / f64::from(steps)
        })
        .sum();
    let flat = direction.with_z(0.0).normalize();
    (enters + flat * aside - DVec3::Z * depth, direction)
}

fn layers(backend: &str, form: &str, step: f64) -> (f64, usize) {
    // Centre to centre the field is linear: u = z / 24. The outermost voxels, whose gradients are one-sided, bend nothing.
    let index = |u: f64| {
        let inner = (24.0 * u - 2.0) / 20.0;
        1.0 + 0.5 * (PI * inner.clamp(0.0, 1.0)).sin().powi(2)
    };
    let points: String = (0..=1024)
        .map(|i| f64::from(i) / 1024.0)
        .map(|u| format!("({u:?}, {:?}),", index(u)))
        .collect();
    let colors = format!(
        "(domain: data, color: (1, 1, 1), extinction: [(0, 0), (1, 0)], refraction: [{points}])"
    );
    let stage = Stage::new()
        .with_floats("v", [49, 49, 25], |_, _, z| z as f32 / 24.0)
        .with("transfer.ron", colors)
        .with(
            "graph.ron",
            graph(
                r#"path: "v_49x49x25_float32.raw", node_centred: true"#,
                "orbit(azimuth: 90, elevation: 45, projection: orthographic)",
                PLACES,
                // In f32: stored gradients are half floats.
                r#"{ "technique": "refraction", "gradient": "central" }"#,
                &format!(r#"{{ "step": {step:?} }}"#),
            ),
        );
    let drawn = render(&stage, &[&format!("image.stage={form}")], backend, [24, 24]);
    let sides = (DVec3::ZERO, DVec3::new(48.0, 48.0, 24.0));
    let beyond = Beyond::new(&drawn.1, sides, 2.0);
    worst(&drawn, 1e-1, |ray| {
        let (leaves, direction) = through_layers(ray, 24.0, index);
        let enters = ray.0 + ray.1 * ((ray.0.z - 24.0) / -ray.1.z);
        let is_inside = |p: DVec3| p.x.min(p.y) > 1.0 && p.x.max(p.y) < 47.0;
        (is_inside(enters) && is_inside(leaves)).then(|| beyond.color(leaves, direction))
    })
}

#[test]
fn through_layers_the_sine_times_the_index_is_kept_and_the_error_is_of_order_two() {
    for backend in adapters() {
        let steps = [2.0, 1.0, 0.5, 0.25];
        let errors = steps.map(|step| layers(&backend, "compute", step));
        assert!(errors[0].1 > 60, "{errors:?}");
        // The scheme's error falls with the square of the step.
        let logs: Vec<(f64, f64)> = steps
            .iter()
            .zip(errors)
            .map(|(step, (error, _))| (step.ln(), error.ln()))
            .collect();
        let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / 4.0;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let slope = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
            / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
        assert!(slope > 1.8, "{backend}: order {slope}, {errors:?}");
        assert!(errors[3].0 < 1e-3, "{backend}: {errors:?}");
        let fragment = layers(&backend, "fragment", 0.25).0;
        assert!((fragment - errors[3].0).abs() < 1e-5);
    }
}

#[test]
fn in_a_parabolic_medium_rays_are_ellipses() {
    // n² = n0² - a² r²: with ds = n dσ, r'' = -a² r, so r(σ) = r0 cos aσ + n d / a sin aσ.
    let (n0, a) = (1.8, 0.05);
    let points: String = (0..=512)
        .map(|i| f64::from(i) * 896.0 / 512.0)
        .map(|square| format!("({square:?}, {:?}),", (n0 * n0 - a * a * square).sqrt()))
        .collect();
    let colors = format!(
        "(domain: data, color: (1, 1, 1), extinction: [(0, 0), (896, 0)], refraction: [{points}])"
    );
    // Corners of the box are at r² = 3 · 17² = 867, where n is still 1.04.
    let value = |x: u32, y: u32, z: u32| {
        (DVec3::new(f64::from(x), f64::from(y), f64::from(z)) - 17.0).length_squared() as f32
    };
    // The outermost voxels, whose gradients are one-sided, are cut off; the cut bends nothing.
    let clip = r#"// Which part of the ray is visible: a box in the middle.
#import "lib/volume.wgsl"

fn clip_next(ray: Ray) -> vec2f {
    let place = ray_world(ray, 0.0) - volume.centre;
    let slope = select(ray.direction, vec3f(1.0e-20), abs(ray.direction) < vec3f(1.0e-20));
    let first = min((-15.0 - place) / slope, (15.0 - place) / slope);
    let last = max((-15.0 - place) / slope, (15.0 - place) / slope);
    let start = max(max(max(first.x, first.y), first.z), 0.0);
    return vec2f(start, max(min(min(last.x, last.y), last.z), start));
}

fn clip_normal(ray: Ray, distance: f32) -> vec3f {
    return -ray.direction;
}
"#;
    for camera in [
        "orbit(azimuth: 33, elevation: 21, fov_y: 30)",
        "orbit(azimuth: 110, elevation: -35, projection: orthographic)",
    ] {
        let stage = Stage::new()
            .with("slot/clip/inner.wgsl", clip)
            .with_floats("v", [35, 35, 35], value)
            .with("transfer.ron", &colors)
            .with(
                "graph.ron",
                graph(
                    r#"path: "v_35x35x35_float32.raw", node_centred: true"#,
                    camera,
                    PLACES,
                    r#"{ "technique": "refraction", "clip": "inner" }"#,
                    r#"{ "step": 0.5 }"#,
                ),
            );
        let (low, high) = (DVec3::splat(2.0), DVec3::splat(32.0));
        for backend in adapters() {
            let drawn = render(&stage, &[], &backend, [32, 32]);
            let whole = (DVec3::ZERO, DVec3::splat(34.0));
            let beyond = Beyond::new(&drawn.1, whole, 2.0);
            let truth = |ray: (DVec3, DVec3)| {
                let Some((near, _)) = volgraph_tests::box_interval(ray, low, high) else {
                    return Some(beyond.color(ray.0, ray.1));
                };
                let r = ray.0 + ray.1 * near - 17.0;
                let v = ray.1 * (n0 * n0 - a * a * r.length_squared()).sqrt();
                let at = |sigma: f64| {
                    let (sine, cosine) = (a * sigma).sin_cos();
                    (r * cosine + v * (sine / a), v * cosine - r * (sine * a))
                };
                // The first way out of the box: in steps that no corner is shorter than, then halved.
                let is_out = |sigma: f64| at(sigma).0.abs().max_element() > 15.0;
                let mut high = 1e-3;
                while !is_out(high) {
                    high += 1e-2;
                }
                let mut low = (high - 1e-2).max(0.0);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if is_out(middle) {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                let (place, momentum) = at(high);
                Some(beyond.color(place + 17.0, momentum.normalize()))
            };
            let (error, compared) = worst(&drawn, 1e-4, truth);
            // The trilinear square is too high by 0.75 at most, n too low by a² 0.75 / (2 n) < 1e-3: as much of the
            // direction, and of the height on a plane that is about as far as it is high.
            assert!(error < 1e-3, "{backend} {camera}: {error}");
            assert!(compared > 300, "{compared}");
        }
    }
}

#[test]
fn without_an_index_the_picture_is_that_of_straight_rays() {
    for (classify, light) in [("post", "phong"), ("preintegrated_2d", "unlit")] {
        let colors = "(domain: data, points: [(at: 0, color: (1, 0.2, 0), opacity: 0.0), (at: 30, color: (0, 0.5, 1), opacity: 0.2)]";
        let slots =
            format!(r#"{{ "technique": "dvr", "classify": "{classify}", "light": "{light}" }}"#);
        let value = |x: u32, y: u32, z: u32| ((x * 3 + y * 5 + z * 7) % 31) as f32;
        let camera = "orbit(azimuth: 33, elevation: 21, fov_y: 40)";
        let plain = stage([12; 3], value, camera, &slots, "{}", &format!("{colors})"));
        // Glass of one index everywhere bends nothing either.
        for index in ["", ", refraction: [(0, 1.5), (30, 1.5)]"] {
            let bent = stage(
                [12; 3],
                value,
                camera,
                &slots,
                "{}",
                &format!("{colors}{index})"),
            );
            for backend in adapters() {
                for form in STAGES {
                    let form = format!("image.stage={form}");
                    // Only where both are read at once would straight rays choose others.
                    let gradients = "image.slots.gradient_storage=rgba16f";
                    let straight = render(&plain, &[&form, gradients], &backend, [40, 40]).0;
                    let bending = "image.slots.technique=refraction";
                    let sets = [form.as_str(), bending, gradients];
                    let refracted = render(&bent, &sets, &backend, [40, 40]).0;
                    let difference = |a: &[f32], b: &[f32]| {
                        a.iter()
                            .zip(b)
                            .map(|(a, b)| (a - b).abs())
                            .fold(0.0, f32::max)
                    };
                    let color = difference(
                        straight.color.as_flattened(),
                        refracted.color.as_flattened(),
                    );
                    let opacity = difference(
                        straight.opacity.as_ref().unwrap(),
                        refracted.opacity.as_ref().unwrap(),
                    );
                    assert!(
                        color <= 1e-5 && opacity <= 1e-5,
                        "{backend} {form} {color} {opacity}"
                    );
                }
            }
        }
    }
}
