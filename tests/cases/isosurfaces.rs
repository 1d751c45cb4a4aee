//! Isosurfaces against float64 roots of the trilinear field, against exact quadrics, and against closed-form compositing.
//!
//! Two fields do it. Of the trilinear field the crossings are roots of cubics, found in float64 from the same voxels.
//! Of voxels that hold the square of the distance from a point, `catmull_rom` is that quadric itself (it reproduces
//! polynomials of degree 2 along each axis), and `tricubic` is the quadric plus 1 (a B-spline adds a third of x² per axis).

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_tests::trilinear::Trilinear;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

const DIMS: [u32; 3] = [22; 3];
const CENTRE: DVec3 = DVec3::new(10.3, 10.7, 10.9);
const RADIUS: f64 = 7.0;
const LOW: DVec3 = DVec3::splat(-0.5);
const HIGH: DVec3 = DVec3::splat(21.5);
const SIZE: [u32; 2] = [32, 32];
const ORBIT: &str = "orbit(azimuth: 33, elevation: 21, fov_y: 32, distance: 30)";

fn distance(x: u32, y: u32, z: u32) -> f64 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z)).distance(CENTRE)
}

fn quadric(x: u32, y: u32, z: u32) -> f32 {
    distance(x, y, z).powi(2) as f32
}

/// A thin shell: peaks of 1 on the sphere, 0 farther than 0.8 voxels from it.
fn shell(x: u32, y: u32, z: u32) -> f32 {
    (1.0 - (distance(x, y, z) - RADIUS).abs() / 0.8).max(0.0) as f32
}

/// A sphere with ripples of a voxel's size, so that rays meet it several times and cells have several roots.
fn rippled(x: u32, y: u32, z: u32) -> f32 {
    (distance(x, y, z) + 0.9 * f64::from((x * 7 + y * 5 + z * 3) % 5) - 1.8) as f32
}

fn stage(value: fn(u32, u32, u32) -> f32, camera: &str, slots: &str, params: &str) -> Stage {
    let volume = format!(r#"path: "v_{0}x{0}x{0}_float32.raw""#, DIMS[0]);
    let graph = graph(&volume, camera, "{}", slots, params);
    let normal = r#""color": "image.color", "normal": "image.normal""#;
    Stage::new()
        .with_floats("v", DIMS, value)
        .with(
            "transfer.ron",
            "(points: [(at: 0, color: (1, 1, 1), opacity: 0)])",
        )
        .with(
            "graph.ron",
            graph.replace(r#""color": "image.color""#, normal),
        )
}

/// All pixels whose ray meets the box: number, ray, and where it enters and leaves.
fn rays(view: &View) -> impl Iterator<Item = (usize, (DVec3, DVec3), (f64, f64))> {
    let pixels = (0..view.size[1]).flat_map(|y| (0..view.size[0]).map(move |x| (x, y)));
    pixels.enumerate().filter_map(|(at, (x, y))| {
        let ray = ray(view, x, y);
        Some((at, ray, box_interval(ray, LOW, HIGH)?))
    })
}

fn depth(picture: &Picture, at: usize) -> f64 {
    f64::from(picture.depth.as_ref().unwrap()[at])
}

/// Where a ray meets a sphere around [`CENTRE`] first, and the cosine between it and the normal there.
fn sphere((origin, direction): (DVec3, DVec3), radius: f64) -> Option<(f64, f64)> {
    let middle = (CENTRE - origin).dot(direction);
    let aside = (CENTRE - origin - direction * middle).length();
    let half = (radius * radius - aside * aside).max(0.0).sqrt();
    (aside < radius).then_some((middle - half, half / radius))
}

/// Every scalar of a shader in f32 is off by some roundings of the largest of the eight voxels less the level.
const SCALAR_ERROR: f64 = 2e-5;

/// Compares the depths with the first crossings in float64. Gives the largest error where the field changes by a twentieth
/// and more per voxel along the ray, the number of such pixels, and that of pixels that are wrong by more than rounding
/// of the scalars explains: a rounded scalar moves a hit by its error over the slope, and loses or finds a grazed one.
fn worst_hit(picture: &Picture, view: &View, field: &Trilinear, level: f64) -> (f64, usize, usize) {
    let (mut worst, mut steep, mut wrong) = (0.0_f64, 0, 0);
    for (at, ray, interval) in rays(view) {
        let seen = depth(picture, at);
        let first = |level: f64| field.crossings(ray, interval, level).first().copied();
        let error = |truth: Option<(f64, f64)>| match truth {
            Some((distance, _)) => (seen - distance).abs(),
            None if seen == f64::INFINITY => 0.0,
            None => f64::INFINITY,
        };
        let truth = first(level);
        if let Some((_, slope)) = truth
            && slope.abs() > 0.05
            && error(truth) < 0.1
        {
            steep += 1;
            worst = worst.max(error(truth));
        } else if error(truth) > 1e-3 {
            let moved =
                [level - SCALAR_ERROR, level + SCALAR_ERROR].map(|level| error(first(level)));
            wrong += usize::from(moved.iter().all(|error| *error > 1e-3));
        }
    }
    (worst, steep, wrong)
}

#[test]
fn cubic_hits_are_the_roots_of_the_trilinear_field() {
    type Case = (fn(u32, u32, u32) -> f32, f64, &'static str);
    let cases: [Case; 3] = [
        (|x, y, z| distance(x, y, z) as f32, RADIUS, "below"),
        (rippled, RADIUS, "below"),
        (shell, 0.5, "above"),
    ];
    for (value, level, solid) in cases {
        let params = format!(
            r#"{{ "refinement": "cubic", "isovalue": {level:?}, "isovalue_unit": "data", "solid": "{solid}" }}"#
        );
        let stage = stage(value, ORBIT, r#"{ "technique": "isosurface" }"#, &params);
        let field = Trilinear::new(DIMS, value);
        for backend in adapters() {
            for (form, step) in [(STAGES[0], 4.0), (STAGES[1], 0.7), (STAGES[1], 64.0)] {
                let sets = [format!("image.stage={form}"), format!("image.step={step}")];
                let (picture, view) =
                    render(&stage, &sets.each_ref().map(String::as_str), &backend, SIZE);
                let (worst, steep, wrong) = worst_hit(&picture, &view, &field, level);
                let what =
                    format!("{backend} {sets:?} {level}: {worst} over {steep}, {wrong} wrong");
                assert!(worst <= 1e-5 * 2.0 * RADIUS, "{what}");
                assert!(steep > 150 && wrong == 0, "{what}");
            }
        }
        // The check itself must see a level that is a ten-thousandth off.
        let (picture, view) = render(&stage, &[], &adapters()[0], SIZE);
        let (worst, _, _) = worst_hit(&picture, &view, &field, level + 3e-4);
        assert!(worst > 1e-5 * 2.0 * RADIUS, "{worst}");
    }
}

#[test]
fn a_thin_shell_is_lost_at_large_steps_but_not_by_cubics() {
    let params = r#"{ "step": 4.0, "isovalue": 0.5, "isovalue_unit": "data" }"#;
    let stage = stage(shell, ORBIT, r#"{ "technique": "isosurface" }"#, params);
    let field = Trilinear::new(DIMS, shell);
    for backend in adapters() {
        let share = |refinement: &str| {
            let set = format!("image.refinement={refinement}");
            let (picture, view) = render(&stage, &[&set], &backend, SIZE);
            let (mut met, mut seen) = (0, 0);
            for (at, ray, interval) in rays(&view) {
                let crossings = field.crossings(ray, interval, 0.5);
                if crossings.len() >= 4 {
                    met += 1;
                    seen += u32::from((depth(&picture, at) - crossings[0].0).abs() < 1.0);
                }
            }
            assert!(met > 100);
            f64::from(seen) / f64::from(met)
        };
        for refinement in ["none", "linear", "bisection"] {
            let share = share(refinement);
            assert!(share < 0.5, "{backend} {refinement}: {share}");
        }
        let share = share("cubic");
        assert!(share == 1.0, "{backend} cubic: {share}");
    }
}

/// Errors of the depth of the exact sphere, over the pixels within 0.7 of its radius: mean and largest.
fn sphere_errors(picture: &Picture, view: &View, radius: f64) -> (f64, f64) {
    let errors: Vec<f64> = rays(view)
        .filter_map(|(at, ray, _)| Some((at, sphere(ray, radius)?)))
        .filter(|(_, (_, cosine))| *cosine > 0.7)
        .map(|(at, (distance, _))| (depth(picture, at) - distance).abs())
        .collect();
    assert!(errors.len() > 50);
    let sum: f64 = errors.iter().sum();
    (
        sum / errors.len() as f64,
        errors.iter().copied().fold(0.0, f64::max),
    )
}

const SPHERE: &str = r#"{ "isovalue": 49.0, "isovalue_unit": "data", "solid": "below" }"#;

#[test]
fn refinements_have_their_orders() {
    let slots = r#"{ "technique": "isosurface", "reconstruct": "catmull_rom" }"#;
    let stage = stage(quadric, ORBIT, slots, SPHERE);
    for backend in adapters() {
        let mean = |refinement: &str, step: f64| {
            let sets = [
                format!("image.refinement={refinement}"),
                format!("image.step={step}"),
                "image.stage=compute".to_owned(),
            ];
            let (picture, view) =
                render(&stage, &sets.each_ref().map(String::as_str), &backend, SIZE);
            sphere_errors(&picture, &view, RADIUS).0
        };
        for (refinement, theory) in [("none", 1.0), ("linear", 2.0)] {
            let logs = [2.0, 1.0, 0.5, 0.25, 0.125].map(|step| mean(refinement, step).log2());
            // Least squares over four halvings.
            let order = logs
                .iter()
                .zip([2.0, 1.0, 0.0, -1.0, -2.0])
                .map(|(log, at)| log * at)
                .sum::<f64>()
                / 10.0;
            assert!(
                (order - theory).abs() < 0.1,
                "{backend} {refinement}: {order}, {logs:?}"
            );
        }
        // A sample is half a step behind the crossing on the mean, and never in front.
        let (picture, view) = render(
            &stage,
            &["image.refinement=none", "image.step=0.5"],
            &backend,
            SIZE,
        );
        assert!((sphere_errors(&picture, &view, RADIUS).0 - 0.25).abs() < 0.03);
        let is_behind =
            |(at, ray, _)| sphere(ray, RADIUS).is_none_or(|hit| depth(&picture, at) > hit.0 - 1e-4);
        assert!(rays(&view).all(is_behind), "{backend}");
    }
}

#[test]
fn bisection_halves_the_error() {
    let slots = r#"{ "technique": "isosurface", "reconstruct": "catmull_rom" }"#;
    let stage = stage(quadric, ORBIT, slots, SPHERE);
    for backend in adapters() {
        for form in STAGES {
            for (step, count) in [(4.0, 1), (4.0, 4), (1.0, 6), (1.0, 20)] {
                let sets = [
                    "image.refinement=bisection".to_owned(),
                    format!("image.bisections={count}"),
                    format!("image.step={step}"),
                    format!("image.stage={form}"),
                ];
                let (picture, view) =
                    render(&stage, &sets.each_ref().map(String::as_str), &backend, SIZE);
                let worst = sphere_errors(&picture, &view, RADIUS).1;
                // The middle of what is left, and roundings of scalars and depths.
                let bound = 0.5 * step / 2.0_f64.powi(count) + 2e-5;
                assert!(
                    worst <= bound,
                    "{backend} {form} {step} {count}: {worst} > {bound}"
                );
                assert!(
                    worst > 0.8 * (bound - 2e-5),
                    "{backend} {step} {count}: {worst} shows no halving"
                );
            }
        }
    }
}

#[test]
fn a_b_spline_of_a_quadric_is_that_quadric_plus_one() {
    let slots =
        r#"{ "technique": "isosurface", "reconstruct": "tricubic", "gradient": "tricubic" }"#;
    let stage = stage(quadric, ORBIT, slots, SPHERE);
    for backend in adapters() {
        let sets = ["image.refinement=bisection", "image.bisections=24"];
        let (picture, view) = render(&stage, &sets, &backend, SIZE);
        let worst = sphere_errors(&picture, &view, 48.0_f64.sqrt()).1;
        // Roundings: of scalars up to 100, over a slope of 2 · 7 · 0.7; of the filter's weights, as the device has them.
        assert!(worst <= 1e-4, "{backend}: {worst}");
        let other = sphere_errors(&picture, &view, RADIUS).1;
        assert!(other > 0.05, "{backend}: {other}");
    }
}

#[test]
fn normals_are_within_the_bound_of_their_gradient() {
    let slots =
        r#"{ "technique": "isosurface", "reconstruct": "catmull_rom", "gradient": "GRADIENT" }"#;
    // Angles in radians. Central differences of a quadric are exact at voxels, and linear between them: half floats
    // round each part by 2^-11. Differences of f32 scalars up to 200 from sums of 64. Inside of a cell each part of the
    // trilinear field's gradient is off by at most 1, of a length of 14.
    let half_floats = 3.0_f64.sqrt() / 2048.0;
    let facets = (3.0_f64.sqrt() / (2.0 * RADIUS)).asin();
    for (gradient, bound) in [
        ("stored", half_floats),
        ("central", 1e-5),
        ("tricubic", 1e-5),
        ("analytic", facets),
    ] {
        let params = SPHERE.replace("{ ", r#"{ "refinement": "bisection", "bisections": 20, "#);
        let stage = stage(
            quadric,
            ORBIT,
            &slots.replace("GRADIENT", gradient),
            &params,
        );
        for backend in adapters() {
            for form in STAGES {
                let set = format!("image.stage={form}");
                let mut session = stage.open("graph.ron", &[&set], &backend, SIZE).unwrap();
                let (picture, _) = session.render().unwrap();
                let normals = session.read("normal").unwrap().color;
                let view = *session.view();
                let (mut worst, mut met) = (0.0_f64, 0);
                for (at, ray, _) in rays(&view) {
                    if depth(&picture, at) == f64::INFINITY {
                        assert_eq!(normals[at], [0.0; 4]);
                        continue;
                    }
                    let hit = ray.0 + ray.1 * depth(&picture, at);
                    let normal =
                        DVec3::from_array([0, 1, 2].map(|axis| f64::from(normals[at][axis])));
                    assert!((normal.length() - 1.0).abs() < 1e-5);
                    met += 1;
                    // Turned to the eye: at the outline the sign is rounding's.
                    let sine = normal.cross((hit - CENTRE).normalize()).length();
                    worst = worst.max(sine.asin());
                    assert!(normal.dot(ray.1) <= 1e-6);
                }
                assert!(
                    met > 150 && worst <= bound,
                    "{backend} {form} {gradient}: {worst} > {bound}, {met}"
                );
                assert!(
                    worst > 0.05 * bound,
                    "{backend} {gradient}: {worst} is far below {bound}"
                );
            }
        }
    }
}
