//! Estimated errors against true ones: on every ready graph at least 95 of 100 pixels have a true error of at most twice
//! the estimate, which is not uselessly large, and next to nothing where the picture is exact; closed forms of what the estimate is made of; the float64 reference.
//!
//! Each group of graphs writes its table to `error_estimates_<group>.txt` in the tests' temporary folder.

use std::fmt::Write as _;

use volgraph::{Picture, Session};
use volgraph_tests::layers::scalars;
use volgraph_tests::repository::{PARTS_AND_PROJECTIONS, SOLIDS, VOLUMES};
use volgraph_tests::truth::truth_of;
use volgraph_tests::{STAGES, Stage, adapters, graph, open, render, root};

const SIZE: [u32; 2] = [64, 64];

/// The least share of pixels whose error is within the estimate.
fn least_within(name: &str) -> f64 {
    match name {
        // Naively cut, parts end at whole steps. Where the cut snaps to the same place at both step lengths, the two walks
        // agree, and their difference cannot see by how much both are off.
        "clip_naive" => 0.85,
        _ => 0.95,
    }
}

/// What these pixels have to be within, beside rounding.
const MARGIN: f64 = 2.0;
const ROUNDING: f64 = 1e-5;
/// Estimates much larger than errors would tell nothing.
const MEDIAN: f64 = 12.0;

/// The files of the ready graphs, each with the outputs `color` and `error` of its raycast.
fn ready_graphs(names: &[&str]) -> Stage {
    let graphs = root().join("graphs");
    let mut stage = Stage::new();
    for folder in ["images", "segments", "transfer"] {
        for entry in std::fs::read_dir(graphs.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            stage = stage.with(&format!("{folder}/{name}"), std::fs::read(&path).unwrap());
        }
    }
    for name in names {
        let text = std::fs::read_to_string(graphs.join(format!("{name}.ron"))).unwrap();
        let start = text.rfind("outputs:").unwrap();
        let end = start + text[start..].find('}').unwrap() + 1;
        let with =
            |outputs: &str| format!("{}outputs: {{ {outputs} }}{}", &text[..start], &text[end..]);
        stage = stage
            .with(
                &format!("{name}.ron"),
                with(r#""color": "image.color", "error": "image.error""#),
            )
            .with(
                &format!("{name}_alone.ron"),
                with(r#""color": "image.color""#),
            );
    }
    stage
}

fn picture(mut session: Session) -> Picture {
    session
        .render()
        .unwrap_or_else(|findings| panic!("{findings}"))
        .0
}

/// What a ready graph is drawn with to be the truth of its picture: a sixteenth of its step, to the end of each ray, with
/// crossings found exactly. What only crossings make needs no shorter step, which drivers that bound loops would not walk;
/// what is lit through the solid changes with how crossings are found, too, and is none of the walk's.
fn truth_sets(name: &str, step: f64) -> Vec<String> {
    let (divisor, others): (f64, &[&str]) = match name {
        "environment" | "isosurface" | "matcap" | "refraction_surface" | "shadow" => {
            (2.0, &["image.refinement=cubic"])
        }
        "isosurfaces_translucent" => (
            2.0,
            &["image.refinement=cubic", "image.early_termination=0"],
        ),
        // Between its surfaces it is integrated.
        "isosurface_dvr" => (
            16.0,
            &["image.refinement=cubic", "image.early_termination=0"],
        ),
        // No cubic runs along its rays.
        "tricubic" => (16.0, &["image.refinement=bisection", "image.bisections=20"]),
        "translucency" => (2.0, &[]),
        // These have no opacity to end at.
        "average" | "minip" | "mip" | "xray" => (16.0, &[]),
        _ => (16.0, &["image.early_termination=0"]),
    };
    let step = format!("image.step={}", step / divisor);
    let sets = ["image.stage=compute", &step].into_iter();
    sets.chain(others.iter().copied())
        .map(str::to_owned)
        .collect()
}

fn truth(stage: &Stage, name: &str, step: f64, backend: &str) -> Picture {
    let sets = truth_sets(name, step);
    let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
    let session = stage.open(&format!("{name}_alone.ron"), &sets, backend, SIZE);
    picture(session.unwrap_or_else(|findings| panic!("{name}: {findings}")))
}

fn estimates(picture: &Picture) -> Vec<f64> {
    scalars(picture, "error")
        .iter()
        .map(|it| f64::from(*it))
        .collect()
}

/// The largest error of each pixel's components.
fn errors(picture: &Picture, truth: impl Iterator<Item = [f64; 4]>) -> Vec<f64> {
    let error = |(pixel, truth): (&[f32; 4], [f64; 4])| {
        let component = |i: usize| (f64::from(pixel[i]) - truth[i]).abs();
        (0..4).map(component).fold(0.0, f64::max)
    };
    picture.color.iter().zip(truth).map(error).collect()
}

struct Found {
    /// Share of the pixels whose error is within the estimate.
    within: f64,
    /// Median of estimate over error, of pixels with an error; none where there are next to none.
    median: Option<f64>,
    rmse: f64,
    rms_estimate: f64,
}

impl Found {
    /// Whether the estimate tells something: it is near the errors, and next to nothing where there are none.
    fn is_useful(&self) -> bool {
        match self.median {
            Some(median) => median <= MEDIAN,
            None => self.rms_estimate <= ROUNDING,
        }
    }
}

fn compare(errors: &[f64], estimates: &[f64]) -> Found {
    let pairs = || errors.iter().zip(estimates);
    let count = errors.len() as f64;
    let within = pairs().filter(|(error, estimate)| **error <= MARGIN * **estimate + ROUNDING);
    let mut ratios: Vec<f64> = pairs()
        .filter(|(error, _)| **error > ROUNDING)
        .map(|(error, estimate)| estimate / error)
        .collect();
    ratios.sort_by(f64::total_cmp);
    let rms = |values: &[f64]| (values.iter().map(|it| it * it).sum::<f64>() / count).sqrt();
    Found {
        within: within.count() as f64 / count,
        median: (ratios.len() >= 10).then(|| ratios[ratios.len() / 2]),
        rmse: rms(errors),
        rms_estimate: rms(estimates),
    }
}

/// The step that a graph gives its raycast.
fn step(name: &str) -> f64 {
    let text = std::fs::read_to_string(root().join(format!("graphs/{name}.ron"))).unwrap();
    text.split_once(r#""step": "#).map_or(1.0, |(_, rest)| {
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.');
        rest[..end.unwrap()].parse().unwrap()
    })
}

fn hold(group: &str, names: &[&str]) {
    let stage = ready_graphs(names);
    let mut table = format!("{:24} within  median  true    estimated\n", "graph");
    let mut wrong = Vec::new();
    let backends = adapters();
    let backend = backends
        .iter()
        .find(|it| *it != "gl")
        .unwrap_or(&backends[0]);
    for (index, name) in names.iter().enumerate() {
        // Both stages come in turn; that they agree, on all backends, is a test of its own. GL has one context for all
        // threads, which these long frames would keep from other tests.
        let form = format!("image.stage={}", STAGES[index % 2]);
        let session = stage.open(&format!("{name}.ron"), &[&form], backend, SIZE);
        let seen = picture(session.unwrap_or_else(|findings| panic!("{name}: {findings}")));
        let truth = truth(&stage, name, step(name), backend);
        let errors = errors(&seen, truth.color.iter().map(|it| it.map(f64::from)));
        let found = compare(&errors, &estimates(&seen));
        let median = found.median.map_or("-".to_owned(), |it| format!("{it:.2}"));
        writeln!(
            table,
            "{name:24} {:5.1} % {median:>6}  {:.1e} {:.1e}",
            100.0 * found.within,
            found.rmse,
            found.rms_estimate
        )
        .unwrap();
        if found.within < least_within(name) || !found.is_useful() {
            wrong.push(*name);
        }
    }
    let file = format!(
        "{}/error_estimates_{group}.txt",
        env!("CARGO_TARGET_TMPDIR")
    );
    std::fs::write(file, &table).unwrap();
    assert!(wrong.is_empty(), "{wrong:?}\n{table}");
}

#[test]
fn estimates_hold_for_solids() {
    hold("solids", SOLIDS);
}

#[test]
fn estimates_hold_for_volumes() {
    hold("volumes", VOLUMES);
}

#[test]
fn estimates_hold_for_parts_and_projections() {
    hold("parts_and_projections", PARTS_AND_PROJECTIONS);
}

/// The reference ends no ray early, and integrates to 1e-7.
#[test]
fn estimates_hold_against_the_reference() {
    let path = root().join("graphs/comparison.ron");
    let size = [24, 24];
    let stage = ready_graphs(&["comparison"]);
    for backend in adapters() {
        for step in ["image.step=1", "image.step=4"] {
            let sets = [step, "volume.dims=(48, 48, 48)"];
            let mut session = stage.open("comparison.ron", &sets, &backend, size).unwrap();
            let seen = session.render().unwrap().0;
            let (truth, _) = truth_of(&path, &sets, size, 1e-7).unwrap();
            let errors = errors(&seen, truth.rendered.color.into_iter());
            let found = compare(&errors, &estimates(&seen));
            println!("{backend} {step}: {:.3}, {:?}", found.within, found.median);
            assert!(
                found.within >= 0.95 && found.median.is_some_and(|median| median < MEDIAN),
                "{backend} {step}: {} within, median {:?}",
                found.within,
                found.median
            );
        }
    }
}

#[test]
fn backends_and_stages_agree() {
    for name in ["quickstart", "clip_sphere"] {
        let stage = ready_graphs(&[name]);
        let mut all: Vec<(String, Picture, Vec<f64>)> = Vec::new();
        for backend in adapters() {
            for form in STAGES {
                let set = format!("image.stage={form}");
                let session = stage.open(&format!("{name}.ron"), &[&set], &backend, [40, 40]);
                let picture = picture(session.unwrap());
                let estimates = estimates(&picture);
                assert!(estimates.iter().all(|it| it.is_finite() && *it >= 0.0));
                all.push((format!("{backend} {form}"), picture, estimates));
            }
        }
        let (first, colors, expected) = &all[0];
        for (other, others, estimates) in &all[1..] {
            let between = errors(others, colors.color.iter().map(|it| it.map(f64::from)));
            // Where backends round a cut to another place, its colours differ, and those of the double walk as well.
            let is_apart = |at: &usize| {
                let (a, b) = (expected[*at], estimates[*at]);
                (a - b).abs() > 2e-5 + 0.05 * a.max(b) + 4.0 * between[*at]
            };
            let apart = (0..expected.len()).filter(is_apart).count();
            println!("{name}: {first} and {other} differ in {apart} pixels");
            // Rays at the silhouette may meet the box or not.
            assert!(
                apart <= 8,
                "{name}: {first} and {other} differ in {apart} of 1600 pixels"
            );
        }
    }
}

const OUTPUTS: (&str, &str) = (
    r#"outputs: { "color": "image.color" }"#,
    r#"outputs: { "color": "image.color", "error": "image.error" }"#,
);

/// Rays along z through the middle of each voxel of 8 × 8, in a medium of white whose depth a voxel is ln 2.
fn medium(slots: &str, params: &str, value: impl Fn(u32) -> f32) -> Stage {
    let camera = "orbit(azimuth: 0, elevation: 90, projection: orthographic)";
    let text = graph(
        r#"path: "v_8x8x8_float32.raw""#,
        camera,
        "{}",
        slots,
        params,
    );
    Stage::new()
        .with_floats("v", [8, 8, 8], |_, _, z| value(z))
        .with(
            "transfer.ron",
            "(domain: data, color: [(0, (1, 1, 1)), (1, (1, 1, 1))], extinction: [(0, 0.0), (1, 0.69314718)])",
        )
        .with("graph.ron", text.replace(OUTPUTS.0, OUTPUTS.1))
}

/// Red and estimate in the middle of the picture.
fn middle(stage: &Stage, sets: &[&str], backend: &str) -> (f64, f64) {
    let (picture, _) = render(stage, sets, backend, [16, 16]);
    let at = 8 * 16 + 8;
    (f64::from(picture.color[at][0]), estimates(&picture)[at])
}

#[test]
fn what_was_left_where_the_walk_ended_is_in_the_estimate() {
    for backend in adapters() {
        for form in STAGES {
            let stage = medium("{}", r#"{ "early_termination": 0.2 }"#, |_| 1.0);
            let form = format!("image.stage={form}");
            // Eight voxels let 1/256 through. Three are walked, of an even medium without error: 1/8 is left. The pair
            // that the walk ends in is made whole, which changes the double walk by its half.
            let (color, estimate) = middle(&stage, &[&form], &backend);
            assert!((color - 0.875).abs() < 1e-5, "{backend} {form}: {color}");
            let expected = 0.125 + 0.0625 * 2f64.sqrt();
            assert!(
                (estimate - expected).abs() < 1e-4,
                "{backend} {form}: {estimate}"
            );
            // Two, the walk's own pair: only what is left.
            let sets = [form.as_str(), "image.early_termination=0.3"];
            let (color, estimate) = middle(&stage, &sets, &backend);
            assert!((color - 0.75).abs() < 1e-5, "{backend} {form}: {color}");
            assert!(
                (estimate - 0.25).abs() < 1e-4,
                "{backend} {form}: {estimate}"
            );
            // All: nothing.
            let (_, estimate) = middle(&stage, &[&form, "image.early_termination=0"], &backend);
            assert!(estimate < 1e-5, "{backend} {form}: {estimate}");
        }
    }
}

#[test]
fn a_hit_that_one_walk_misses_is_an_error_of_its_colour() {
    // A sheet between two samples of the double walk: in voxel 1 from the eye's side, which is the second from above.
    let params = r#"{ "isovalue": 0.5, "isovalue_unit": "data", "step": 1.5, "refinement": "linear",
        "surface_color": [0.4, 0.3, 0.2] }"#;
    let stage = medium(r#"{ "technique": "isosurface" }"#, params, |z| {
        if z == 6 { 1.0 } else { 0.0 }
    });
    for backend in adapters() {
        for form in STAGES {
            let form = format!("image.stage={form}");
            let (color, estimate) = middle(&stage, &[&form], &backend);
            assert_eq!(color as f32, 0.4, "{backend} {form}: the sheet is hit");
            // Before black, as a whole and as its only pair.
            let expected = 2f64.sqrt() * 0.4;
            assert!(
                (estimate - expected).abs() < 1e-5,
                "{backend} {form}: {estimate}"
            );
            // Nothing to hit.
            let (color, estimate) = middle(&stage, &[&form, "image.isovalue=2"], &backend);
            assert_eq!((color, estimate), (0.0, 0.0), "{backend} {form}");
        }
    }
}

/// A double segment of two is one: post-classification at the sample between them, the volume not read again, is what a
/// walk with the double step makes. So the estimate is that of the two pictures' difference, where it has one pair.
#[test]
fn one_pair_differs_as_two_pictures_do() {
    let params = r#"{ "step": 4.0, "early_termination": 0.0 }"#;
    for classify in ["post", "preintegrated_2d"] {
        let slots = format!(r#"{{ "classify": "{classify}" }}"#);
        let stage = medium(&slots, params, |z| (z * z) as f32 / 64.0);
        for backend in adapters() {
            let (color, estimate) = middle(&stage, &[], &backend);
            let (double, _) = middle(&stage, &["image.step=8"], &backend);
            let expected = 2f64.sqrt() * (color - double).abs();
            // f32 and, of pre-integration, tables of two lengths of segments.
            let bound = if classify == "post" {
                1e-5
            } else {
                0.02 * expected + 1e-4
            };
            println!("{backend} {classify}: {estimate:.5} and {expected:.5}");
            assert!(
                expected > 0.005 && (estimate - expected).abs() < bound,
                "{backend} {classify}: {estimate} and {expected}"
            );
        }
    }
}

#[test]
fn nothing_of_it_is_there_where_nobody_wants_it() {
    let stage = ready_graphs(&["quickstart"]);
    let bound = |graph: &str| {
        let session = open(&stage.path().join(graph), &[], &adapters()[0], [8, 8]).unwrap();
        session.plan().to_text().contains("error_out")
    };
    assert!(bound("quickstart.ron"));
    assert!(!bound("quickstart_alone.ron"));
}
