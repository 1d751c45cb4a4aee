//! The ray of a pixel: its segments add up to the pixel, and say what was taken, skipped and ended.

mod probes;

use glam::DVec3;
use volgraph::ray::{RaySegment, Status};
use volgraph::{RayOptions, RayStudy, RayTracer, Session};
use volgraph_tests::{STAGES, Stage, adapters, graph, open, ray, root};

const SIZE: [u32; 2] = [48, 40];

/// Ten pixels, most of them where volumes are.
const PIXELS: [[u32; 2]; 10] = [
    [24, 20],
    [20, 18],
    [27, 23],
    [24, 12],
    [16, 20],
    [30, 16],
    [19, 27],
    [26, 18],
    [22, 24],
    [3, 2],
];

fn ready(name: &str, sets: &[&str], backend: &str) -> Session {
    let path = root().join("graphs").join(name);
    open(&path, sets, backend, SIZE).unwrap_or_else(|findings| panic!("{name}: {findings}"))
}

fn at([x, y]: [u32; 2]) -> [f64; 2] {
    [f64::from(x) + 0.5, f64::from(y) + 0.5]
}

fn largest(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// Each stretch starts where the one before it ends, from the ray's entry to its exit.
fn assert_whole(study: &RayStudy, case: &str) {
    let [near, far] = study.interval.unwrap();
    let mut end = near;
    for segment in &study.segments {
        assert!((segment.start - end).abs() < 1e-4 * (far - near), "{case}");
        end = segment.end;
    }
    assert!((end - far).abs() < 1e-4 * (far - near), "{case}");
}

fn of(study: &RayStudy, status: Status) -> Vec<&RaySegment> {
    let segments = study.segments.iter();
    segments.filter(|it| it.status == status).collect()
}

#[test]
fn the_sum_over_a_ray_is_the_pixel_that_the_session_draws() {
    // Lit matter over a background; a surface; projections; labels; cuts; light from a grid; bent rays; no background.
    let graphs = [
        "quickstart.ron",
        "isosurface.ron",
        "isosurface_dvr.ron",
        "isosurfaces_translucent.ron",
        "hydrogen.ron",
        "mip.ron",
        "average.ron",
        "segments.ron",
        "clip_planes.ron",
        "volume_shadow.ron",
        "refraction.ron",
        "refraction_surface.ron",
    ];
    for backend in adapters() {
        for name in graphs {
            // What is cut away is no part of the walk.
            let is_cut = ["clip_planes.ron", "segments.ron"].contains(&name);
            let mut session = ready(name, &[], &backend);
            let (picture, _) = session.render().unwrap();
            let mut tracer = RayTracer::of(&session).unwrap();
            let options = RayOptions {
                with_reference: false,
                ..RayOptions::default()
            };
            let mut shown = 0;
            for pixel in PIXELS {
                let study = tracer.study(session.view(), at(pixel), &options).unwrap();
                let case = format!("{name} at {pixel:?} on {backend}");
                let number = (pixel[1] * SIZE[0] + pixel[0]) as usize;
                let drawn = picture.color[number].map(f64::from);
                let opacity = f64::from(picture.opacity.as_ref().unwrap()[number]);
                let sum = study.sum();
                // Before the background and over it.
                assert!(
                    largest(sum, study.color) < 1e-5,
                    "{case}: {sum:?} {study:?}"
                );
                assert!((sum[3] - opacity).abs() < 1e-3, "{case}: {sum:?} {opacity}");
                let open = if study.bends > 0 { 0.0 } else { 1.0 - sum[3] };
                let over = std::array::from_fn(|i| sum[i] + open * study.behind[i]);
                assert!(largest(over, drawn) < 1e-3, "{case}: {over:?} {drawn:?}");
                assert!(largest(study.picture, study.over) < 1e-5, "{case}");
                assert_eq!(study.untold, 0, "{case}");
                if study.bends == 0 && study.interval.is_some() && !is_cut {
                    assert_whole(&study, &case);
                }
                shown += usize::from(opacity > 0.01);
            }
            assert!(shown >= 3, "{name}: most pixels show nothing");
        }
    }
}

/// A constant volume of 16 voxels to a side in a box of 24 × 16 × 8 world units, of extinction 0.1 per world unit.
fn constant(extinction: f64, slots: &str, params: &str) -> Stage {
    let volume = r#"path: "v_16x16x16_float32.raw", spacing: (1.5, 1, 0.5), origin: (5, 6, 7)"#;
    let camera = "orbit(azimuth: 30, elevation: 20)";
    // Extinctions are per length of the smallest spacing.
    let transfer = format!(
        "(color: (1, 0.5, 0.25), extinction: [(0, {})])",
        0.5 * extinction
    );
    Stage::new()
        .with_floats("v", [16; 3], |_, _, _| 3.0)
        .with("transfer.ron", transfer)
        .with("graph.ron", graph(volume, camera, "{}", slots, params))
}

#[test]
fn along_even_matter_everything_is_the_closed_form() {
    let stage = constant(0.1, "{}", r#"{ "early_termination": 0, "step": 2 }"#);
    let [low, high] = [[4.25, 5.5, 6.75], [28.25, 21.5, 14.75]].map(DVec3::from_array);
    for backend in adapters() {
        for form in STAGES {
            let sets = [format!("image.stage={form}")];
            let session = stage
                .open("graph.ron", &[&sets[0]], &backend, SIZE)
                .unwrap();
            let study = RayStudy::of(&session, [24.5, 20.5]).unwrap();
            let own = ray(session.view(), 24, 20);
            let (near, far) = volgraph_tests::box_interval(own, low, high).unwrap();
            let interval = study.interval.unwrap();
            assert!((interval[0] - near).abs() < 1e-9 && (interval[1] - far).abs() < 1e-9);
            let through = |distance: f64| (-0.1 * (distance - near)).exp();
            assert!(study.segments.len() > 8, "{study:?}");
            assert_whole(&study, form);
            for segment in &study.segments {
                let [before, after] = segment.transmittance;
                assert!(
                    (before - through(segment.start)).abs() < 1e-4,
                    "{segment:?}"
                );
                assert!((after - through(segment.end)).abs() < 1e-4, "{segment:?}");
                assert!(
                    (segment.extinction.unwrap() - 0.1).abs() < 1e-3,
                    "{segment:?}"
                );
                assert_eq!(segment.scalars, Some([3.0, 3.0]));
                // White light of this colour is what does not pass.
                let red = before - after;
                let [r, g, b] = segment.contribution;
                assert!((r - red).abs() < 1e-5 && (g - 0.5 * red).abs() < 1e-5);
                assert!((b - 0.25 * red).abs() < 1e-5);
            }
            let reference = study.reference.unwrap();
            assert!(reference.points.len() >= 400, "{}", reference.points.len());
            for point in &reference.points {
                let open = through(point.distance);
                assert!((point.transmittance - open).abs() < 1e-7, "{point:?}");
                assert!(
                    (point.color[1] - 0.5 * (1.0 - open)).abs() < 1e-7,
                    "{point:?}"
                );
                assert!((point.extinction - 0.1).abs() < 1e-12 && point.scalar == 3.0);
                assert_eq!(point.emission, [1.0, 0.5, 0.25]);
            }
        }
    }
}

#[test]
fn the_reference_beside_it_is_what_a_finer_step_comes_to() {
    for backend in adapters() {
        for name in [
            "quickstart.ron",
            "isosurface.ron",
            "mip.ron",
            "xray.ron",
            "average.ron",
        ] {
            let session = ready(name, &["image.step=0.125"], &backend);
            let mut tracer = RayTracer::of(&session).unwrap();
            for pixel in &PIXELS[..4] {
                let study = tracer
                    .study(session.view(), at(*pixel), &RayOptions::default())
                    .unwrap();
                let case = format!("{name} at {pixel:?} on {backend}: {:?}", study.no_reference);
                let reference = study.reference.as_ref().expect(&case);
                let error = study.error().unwrap();
                assert!(error < 5e-3, "{case}: {error}");
                // Its curve ends at its colour.
                let last = reference.points.last().unwrap();
                let [r, g, b] = last.color;
                let end = [r, g, b, 1.0 - last.transmittance];
                let gap = largest(end, reference.color);
                let bound = if name == "xray.ron" { 1e-3 } else { 1e-6 };
                assert!(gap < bound, "{case}: {end:?} {:?}", reference.color);
            }
        }
    }
}

/// A ball in the middle of 64³, of a quarter of the box.
fn ball(slots: &str, params: &str) -> Stage {
    let field = |x: u32, y: u32, z: u32| {
        let from = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) - 31.5;
        (1.0 - from.length() / 16.0).max(0.0) as f32
    };
    let volume = r#"path: "v_64x64x64_float32.raw""#;
    let camera = "orbit(azimuth: 20, elevation: 30)";
    Stage::new()
        .with_floats("v", [64; 3], field)
        .with(
            "transfer.ron",
            "(points: [(at: 0, color: (1, 1, 1), opacity: 0), (at: 1, color: (1, 1, 1), opacity: 0.1)])",
        )
        .with("graph.ron", graph(volume, camera, "{}", slots, params))
}

#[test]
fn what_is_leapt_over_is_marked_and_holds_nothing() {
    let stage = ball(r#"{ "traverse": "skip" }"#, "{}");
    for backend in adapters() {
        let session = stage.open("graph.ron", &[], &backend, SIZE).unwrap();
        let study = RayStudy::of(&session, [24.0, 20.0]).unwrap();
        let skipped = of(&study, Status::Skipped);
        assert!(!skipped.is_empty(), "{study:?}");
        assert_whole(&study, &backend);
        let length: f64 = skipped.iter().map(|it| it.end - it.start).sum();
        let [near, far] = study.interval.unwrap();
        assert!(length > 0.3 * (far - near), "{length} of {}", far - near);
        for segment in &skipped {
            assert_eq!(segment.contribution, [0.0; 3]);
            assert!(segment.scalars.is_none() && segment.extinction.is_none());
            let points = study.reference.as_ref().unwrap().points.iter();
            for point in points {
                let is_in = segment.start < point.distance && point.distance < segment.end;
                assert!(!is_in || point.extinction == 0.0, "{segment:?} {point:?}");
            }
        }
        // The same ray without leaps.
        let plain = ["image.slots.traverse=uniform"];
        let session = stage.open("graph.ron", &plain, &backend, SIZE).unwrap();
        let uniform = RayStudy::of(&session, [24.0, 20.0]).unwrap();
        assert!(of(&uniform, Status::Skipped).is_empty());
        assert!(largest(uniform.sum(), study.sum()) < 1e-6);
        assert!(of(&study, Status::Taken).len() < of(&uniform, Status::Taken).len());
    }
}

#[test]
fn what_lies_behind_an_early_end_is_marked() {
    let stage = constant(2.0, "{}", r#"{ "early_termination": 0.01 }"#);
    for backend in adapters() {
        let session = stage.open("graph.ron", &[], &backend, SIZE).unwrap();
        let study = RayStudy::of(&session, [24.0, 20.0]).unwrap();
        let [ended] = of(&study, Status::Ended)[..] else {
            panic!("{study:?}");
        };
        assert_eq!(ended.index + 1, study.segments.len());
        assert!(ended.transmittance[0] < 0.01 && ended.scalars.is_none());
        let before = &study.segments[ended.index - 1];
        assert!(before.transmittance[0] >= 0.01, "{before:?}");
        assert_whole(&study, &backend);
        let to_the_end = ["image.early_termination=0"];
        let session = stage
            .open("graph.ron", &to_the_end, &backend, SIZE)
            .unwrap();
        let study = RayStudy::of(&session, [24.0, 20.0]).unwrap();
        assert!(of(&study, Status::Ended).is_empty());
    }
}

#[test]
fn a_pixel_beside_the_volume_has_an_empty_study_and_one_beside_the_picture_none() {
    let stage = constant(0.1, "{}", "{}");
    for backend in adapters() {
        let session = stage.open("graph.ron", &[], &backend, SIZE).unwrap();
        let study = RayStudy::of(&session, [0.0, 0.0]).unwrap();
        assert!(
            study.interval.is_none() && study.ends.is_none(),
            "{study:?}"
        );
        assert!(study.segments.is_empty() && study.reference.is_none());
        assert_eq!((study.color, study.sum()), ([0.0; 4], [0.0; 4]));
        assert!(study.hit.is_none() && study.strongest.is_none());
        for outside in [
            [48.0, 0.0],
            [0.0, 40.0],
            [-0.1, 0.0],
            [f64::NAN, 0.0],
            [1e300, 1.0],
        ] {
            let findings = RayStudy::of(&session, outside).unwrap_err();
            assert_eq!(findings.sorted()[0].code, "pixel-outside");
        }
    }
}

#[test]
fn walks_that_are_not_a_raycasts_are_refused() {
    for backend in adapters() {
        for name in ["slices.ron", "software.ron", "multipass.ron"] {
            let session = ready(name, &[], &backend);
            let findings = RayStudy::of(&session, [20.0, 20.0]).unwrap_err();
            assert_eq!(findings.sorted()[0].code, "no-raycast", "{name}");
        }
    }
}
