//! Volumes in bricks: the picture is that of the whole volume, level by level what the levels are, within what is asked.

use std::path::Path;

use volgraph::{Change, Outcome, ParamOverride, Picture, Progressive};
use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build};
use volgraph_formats::{Compression, LoadOptions, WriteOptions, load, write};
use volgraph_tests::{Stage, adapters, gpu_alone, options, render};

const SIZE: [u32; 2] = [96, 80];

const TRANSFER: &str = r##"(
    domain: data,
    color: [(0, "#204080"), (0.5, "#d0b060"), (1, "#ffffff")],
    opacity: [(0.2, 0), (0.5, 0.08), (1, 0.3)],
)"##;

/// A wavy field of 0 to 1 with air around it, of sizes that are no whole bricks.
fn field(dims: [u32; 3]) -> impl Fn(u32, u32, u32) -> f32 {
    move |x, y, z| {
        let at = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
        let (x, y, z) = (at(x, dims[0]), at(y, dims[1]), at(z, dims[2]));
        let wave = (9.0 * x).sin() * (8.0 * y).cos() + (7.0 * z).sin();
        let ball = (1.2 - 1.5 * (x * x + y * y + z * z).sqrt()).clamp(0.0, 1.0);
        (ball * (0.5 + 0.25 * wave)) as f32
    }
}

fn graph(source: &str, slots: &str, params: &str) -> String {
    format!(
        r#"(
    sources: {{ "v": {source}, "t": transfer(path: "t.ron") }},
    camera: orbit(azimuth: 35, elevation: 25, zoom: 1.3),
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "box" }},
                  slots: {{ "gradient": "central", {slots} }},
                  params: {{ {params} }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    )
}

const DIMS: [u32; 3] = [70, 61, 50];
const FILE: &str = "f_70x61x50_float32.raw";

/// A volume with a pyramid of bricks of eight voxels.
fn stage() -> Stage {
    let stage = Stage::new()
        .with("t.ron", TRANSFER)
        .with_floats("f", DIMS, field(DIMS));
    pyramid(&stage.path().join(FILE), 8);
    stage
}

fn pyramid(file: &Path, edge: u32) {
    let options = BuildOptions {
        edge,
        ..BuildOptions::default()
    };
    let folder = volgraph_formats::bricks::pyramid_path(file);
    build(file, &folder, &options).unwrap();
}

fn draw(stage: &Stage, graph: &str, backend: &str) -> Picture {
    stage.write("graph.ron", graph);
    render(stage, &[], backend, SIZE).0
}

fn largest(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.color.as_flattened().iter().zip(b.color.as_flattened());
    pairs
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max)
}

fn rmse(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.color.as_flattened().iter().zip(b.color.as_flattened());
    let squares: f64 = pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (squares / a.color.as_flattened().len() as f64).sqrt()
}

const ALL: &str = "tolerance: 0, pixels: 0";

fn bricks(more: &str) -> String {
    format!(r#"bricks(path: "{FILE}", {more})"#)
}

/// Whatever is drawn of it: no seams.
#[test]
fn at_the_finest_level_the_picture_is_that_of_the_whole_volume() {
    let stage = stage();
    let looks = [
        r#""classify": "preintegrated_2d", "traverse": "skip""#,
        r#""classify": "post", "traverse": "uniform", "light": "phong""#,
        r#""technique": "isosurface", "light": "phong""#,
        r#""technique": "mip""#,
        r#""reconstruct": "tricubic", "classify": "post""#,
        r#""reconstruct": "nearest", "classify": "post""#,
        r#""reconstruct": "catmull_rom", "classify": "post", "traverse": "skip""#,
    ];
    for backend in adapters() {
        for look in looks {
            let params = match look {
                look if look.contains("isosurface") => {
                    r#""isovalue": 0.4, "isovalue_unit": "data""#
                }
                look if look.contains("mip") => "",
                _ => r#""early_termination": 0.0"#,
            };
            let whole = draw(
                &stage,
                &graph(&format!(r#"volume(path: "{FILE}")"#), look, params),
                &backend,
            );
            let paged = draw(&stage, &graph(&bricks(ALL), look, params), &backend);
            assert!(whole.color.iter().any(|color| color[3] > 0.3), "{look}");
            let error = largest(&whole, &paged);
            // A surface's normal is a difference of scalars, whose roundings it has over its length.
            assert!(error <= 1e-4, "{backend} {look}: {error}");
        }
    }
}

/// A normal beside what is not seen is made of scalars there too.
#[test]
fn bricks_beside_what_is_seen_are_as_fine() {
    let dims = [128, 64, 64];
    // Stripes one voxel away from a brick in which nothing is seen, and far from everything else.
    let stage = Stage::new()
        .with("t.ron", TRANSFER)
        .with_floats("s", dims, |x, y, _| {
            f32::from(u8::from(x == 65 && y / 2 % 2 == 0))
        });
    pyramid(&stage.path().join("s_128x64x64_float32.raw"), 8);
    let look = r#""classify": "post", "light": "phong", "traverse": "skip""#;
    let params = r#""step": 0.25, "early_termination": 0.0"#;
    for backend in adapters() {
        let whole = graph(r#"volume(path: "s_128x64x64_float32.raw")"#, look, params);
        let source = format!(r#"bricks(path: "s_128x64x64_float32.raw", {ALL})"#);
        let whole = draw(&stage, &whole, &backend);
        let paged = draw(&stage, &graph(&source, look, params), &backend);
        assert!(whole.color.iter().any(|color| color[3] > 0.1));
        let error = largest(&whole, &paged);
        assert!(error <= 1e-4, "{backend}: {error}");
    }
}

/// A level alone is the picture of that level as a volume, but for the segments, which are as long as its voxels.
#[test]
fn a_coarser_level_is_drawn_as_what_it_is() {
    // Sizes that halve, so that levels share their bricks' faces.
    let dims = [64, 48, 32];
    let stage = Stage::new()
        .with("t.ron", TRANSFER)
        .with_floats("g", dims, field(dims));
    let file = stage.path().join("g_64x48x32_float32.raw");
    pyramid(&file, 8);
    let store = BrickStore::open(&file, &StoreOptions::default()).unwrap();
    for level in [1, 2] {
        let grid = store.levels()[level].grid;
        let voxels = store.read_region(level, [0; 3], grid.dims).unwrap();
        let volume = volgraph_volume::Volume::new("level", grid, voxels).unwrap();
        let options = WriteOptions {
            compression: Some(Compression::None),
            ..WriteOptions::default()
        };
        write(
            &volume,
            &stage.path().join(format!("level{level}.nrrd")),
            &options,
        )
        .unwrap();
    }
    let look = r#""classify": "post", "traverse": "uniform""#;
    for backend in adapters() {
        for level in [1, 2_u32] {
            let source =
                format!(r#"bricks(path: "g_64x48x32_float32.raw", {ALL}, finest: {level})"#);
            let paged = draw(&stage, &graph(&source, look, r#""step": 0.05"#), &backend);
            // Opacities hold for voxels of the finest level.
            let world = TRANSFER.replacen(
                "domain: data,",
                "domain: data, reference_length: (world: 1.0),",
                1,
            );
            stage.write("t.ron", world);
            let whole = draw(
                &stage,
                &graph(
                    &format!(r#"volume(path: "level{level}.nrrd")"#),
                    look,
                    r#""step": 0.05"#,
                ),
                &backend,
            );
            stage.write("t.ron", TRANSFER);
            let error = largest(&whole, &paged);
            assert!(error <= 5e-4, "{backend} level {level}: {error}");
            assert!(whole.color.iter().any(|color| color[3] > 0.3));
        }
    }
}

#[test]
fn finer_levels_are_nearer_to_the_truth_and_a_smaller_tolerance_reads_them() {
    let stage = stage();
    let look = r#""classify": "preintegrated_2d", "traverse": "skip""#;
    for backend in adapters() {
        let truth = draw(&stage, &graph(&bricks(ALL), look, ""), &backend);
        let errors: Vec<f64> = (1..4)
            .map(|level| {
                let source = bricks(&format!("{ALL}, finest: {level}"));
                rmse(&truth, &draw(&stage, &graph(&source, look, ""), &backend))
            })
            .collect();
        assert!(
            errors.is_sorted() && errors[0] > 1e-5,
            "{backend} {errors:?}"
        );
        let errors: Vec<f64> = [0.0003, 0.003, 0.03]
            .map(|tolerance| {
                let source = bricks(&format!("tolerance: {tolerance}, pixels: 0"));
                rmse(&truth, &draw(&stage, &graph(&source, look, ""), &backend))
            })
            .to_vec();
        assert!(
            errors.is_sorted() && errors[2] > errors[0],
            "{backend} {errors:?}"
        );
        // What is asked for and what is there are of one size.
        assert!(
            errors[0] < 0.003 && errors[1] < 0.03,
            "{backend} {errors:?}"
        );
    }
}

/// From frame to frame it gets better, and in the end it is the picture that is whole at once.
#[test]
fn a_progressive_picture_ends_as_the_whole_one_whatever_was_seen_before() {
    let stage = stage();
    let look = r#""classify": "preintegrated_2d", "traverse": "skip""#;
    stage.write(
        "graph.ron",
        graph(&bricks("tolerance: 0.001, pixels: 0"), look, ""),
    );
    for backend in adapters() {
        let at_once = render(&stage, &[], &backend, SIZE).0;
        let progressive = Progressive::default();
        progressive.set(true);
        let mut session = stage
            .open_with(
                "graph.ron",
                &options(&[], &backend, SIZE),
                volgraph::progressive_registry(progressive),
                gpu_alone(&backend),
            )
            .unwrap();
        let finish = |session: &mut volgraph::Session| {
            let (mut frames, mut counts) = (0, Vec::new());
            loop {
                let (picture, report) = session.render_checked().unwrap();
                frames += 1;
                assert!(frames < 1000);
                counts.push(report.progress.ready);
                if report.progress.is_whole() {
                    return (picture, frames, counts);
                }
            }
        };
        let (picture, frames, counts) = finish(&mut session);
        assert!(frames > 1 && counts.is_sorted(), "{counts:?}");
        assert!(
            counts[..counts.len() - 1].iter().any(|count| *count > 0),
            "{counts:?}"
        );
        let error = largest(&picture, &at_once);
        // In other places of the pool, so rounded otherwise.
        assert!(error <= 2e-6, "{backend} {error}");
        // From elsewhere, and back.
        let camera = session.view().camera;
        let mut other = camera;
        other.eye = camera.eye - 0.7 * camera.forward * 20.0 + 10.0 * camera.right;
        session.place_camera(other);
        finish(&mut session);
        session.place_camera(camera);
        let (picture, ..) = finish(&mut session);
        let error = largest(&picture, &at_once);
        // In other places of the pool, so rounded otherwise.
        assert!(error <= 2e-6, "{backend} {error}");
    }
}

/// An edit of something else leaves the bricks on the device where they are, and one of the tolerance the pool.
#[test]
fn edits_keep_the_pool() {
    let stage = stage();
    stage.write("graph.ron", graph(&bricks(ALL), r#""light": "phong""#, ""));
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, SIZE).unwrap();
        session.render().unwrap();
        let mut set = |text: &str| {
            let set = ParamOverride::parse(text).unwrap();
            match session.apply(&Change::Set(vec![set])).unwrap() {
                Outcome::Drawn(drawn) => drawn,
                Outcome::Unchanged => panic!("nothing changed"),
            }
        };
        let drawn = set("image.ambient=0.9");
        let ran = drawn.report.frame.ran().join(" ");
        assert!(ran.contains("image") && !ran.contains("pool"), "{ran}");
        let before = drawn.report.frame.memory;
        let drawn = set("v.tolerance=0.02");
        let ran = drawn.report.frame.ran().join(" ");
        assert!(ran.contains("pool"), "{ran}");
        let after = drawn.report.frame.memory;
        // The table of pages and pictures are made anew.
        assert!(
            after.reused > before.reused && after.bytes == before.bytes,
            "{before:?} {after:?}"
        );
        // Nothing of what is there now is what was read for another tolerance.
        let fresh = render(
            &stage,
            &["v.tolerance=0.02", "image.ambient=0.9"],
            &backend,
            SIZE,
        )
        .0;
        let error = largest(&drawn.picture, &fresh);
        assert!(error <= 2e-6, "{backend} {error}");
    }
}

#[test]
fn a_pool_that_is_too_small_says_so_and_draws_what_it_has() {
    let dims = [64, 64, 64];
    let stage = Stage::new()
        .with("t.ron", TRANSFER)
        .with_floats("h", dims, field(dims));
    pyramid(&stage.path().join("h_64x64x64_float32.raw"), 8);
    let source = format!(r#"bricks(path: "h_64x64x64_float32.raw", {ALL}, pool_mib: 1)"#);
    stage.write("graph.ron", graph(&source, r#""classify": "post""#, ""));
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, SIZE).unwrap();
        let (picture, report) = session.render().unwrap();
        let warnings = report.all_warnings().to_string();
        assert!(
            warnings.contains("pool-full") && warnings.contains("pool_mib"),
            "{warnings}"
        );
        assert!(picture.color.iter().any(|color| color[3] > 0.2));
        assert!(report.memory.bytes < 3 << 20, "{:?}", report.memory);
    }
}

#[test]
fn what_reads_whole_volumes_refuses_bricks() {
    let stage = stage();
    let refused = |graph: String| {
        stage.write("graph.ron", graph);
        let backend = adapters().remove(0);
        match stage.open("graph.ron", &[], &backend, SIZE) {
            Ok(_) => panic!("it was drawn"),
            Err(findings) => findings.to_string(),
        }
    };
    let stored = graph(&bricks(ALL), "", "").replace(
        r#""gradient": "central""#,
        r#""gradient": "stored", "light": "phong""#,
    );
    for text in [
        stored,
        graph(&bricks(ALL), "", "")
            .replace(r#"kind: "raycast""#, r#"kind: "slices""#)
            .replace(r#", "rays": "box""#, "")
            .replace(r#""gradient": "central", "#, ""),
    ] {
        let refused = refused(text);
        assert!(
            refused.contains("in-bricks") && refused.contains("graph.ron"),
            "{refused}"
        );
    }
    let refused = refused(graph(r#"bricks(path: "none.raw")"#, "", ""));
    assert!(
        refused.contains("none.raw") && refused.contains("data-missing"),
        "{refused}"
    );
    let lonely = Stage::new()
        .with("t.ron", TRANSFER)
        .with_floats("f", DIMS, field(DIMS))
        .with("graph.ron", graph(&bricks(ALL), "", ""));
    let backend = adapters().remove(0);
    let findings = lonely
        .open("graph.ron", &[], &backend, SIZE)
        .err()
        .unwrap()
        .to_string();
    assert!(findings.contains("volgraph pyramid"), "{findings}");
    // The volume itself is as it was.
    assert!(load(&lonely.path().join(FILE), &LoadOptions::default()).is_ok());
}
