//! Rays that start from the bricks that are seen draw the picture of those that start from the whole box.

use volgraph::{Change, Outcome, Picture};
use volgraph_measure::compare_without_flip;
use volgraph_tests::{Stage, adapters};

const SIZE: [u32; 2] = [49, 41];
const STAGES: [&str; 2] = ["fragment", "compute"];

const BOX: &str = r#"(kind: "proxy_box", in: { "volume": "v" })"#;
const BRICKS: &str = r#"(kind: "brick_proxy", in: { "volume": "v", "transfer": "t" })"#;

const TRANSFER: &str = "(points: [(at: 0.3, color: (1, 0.5, 0), opacity: 0), (at: 1, color: (0, 0.5, 1), opacity: 0.9)])";

fn graph(proxy: &str, camera: &str, source: &str, image: &str) -> String {
    format!(
        r#"(
    sources: {{ "v": volume(path: "v_37x29x43_float32.raw", {source}), "t": transfer(path: "transfer.ron") }},
    camera: {camera},
    nodes: {{
        "behind": (kind: "background", params: {{ "pattern": "checker" }}),
        "rays":   {proxy},
        "image":  (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "rays", "behind": "behind" }}, {image}),
    }},
    outputs: {{ "color": "image.color", "samples": "image.samples" }},
)"#
    )
}

/// A block away from the middle that nearly fills its bricks, in what has a little noise below where anything absorbs.
fn block(x: u32, y: u32, z: u32) -> f32 {
    let is_in = (10..30).contains(&x) && (10..22).contains(&y) && (2..14).contains(&z);
    let noise = 0.01 * f64::from((x * 7 + y * 13 + z * 29) % 11);
    (f64::from(u8::from(is_in)) * 0.9 + noise) as f32
}

fn stage() -> Stage {
    Stage::new()
        .with_floats("v", [37, 29, 43], block)
        .with("transfer.ron", TRANSFER)
}

/// The picture, and how many rays took samples.
fn draw(stage: &Stage, graph: &str, sets: &[&str], backend: &str) -> (Picture, usize) {
    let mut session = stage
        .open(graph, sets, backend, SIZE)
        .unwrap_or_else(|findings| panic!("{graph} on {backend}: {findings}"));
    let (picture, _) = session.render().unwrap();
    let samples = session.read("samples").unwrap();
    (
        picture,
        samples.color.iter().filter(|it| it[0] > 0.0).count(),
    )
}

#[test]
fn the_picture_is_that_of_the_box_from_fewer_rays() {
    let far = "orbit(azimuth: 30, elevation: 20)";
    let cases = [
        (far, "", ""),
        (
            far,
            "spacing: (1, 1.5, 0.7)",
            r#"slots: { "classify": "post", "light": "phong" }"#,
        ),
        (
            "orbit(azimuth: 200, elevation: -50, zoom: 0.2)",
            "",
            r#"params: { "step": 2.3 }"#,
        ),
        (
            "orbit(azimuth: 100, elevation: 5, projection: orthographic, zoom: 1.3)",
            "node_centred: true",
            r#"slots: { "reconstruct": "tricubic", "traverse": "skip" }"#,
        ),
        // In the block, in the box behind it, and in the box with the block behind the eye.
        (
            "look_at(eye: (27, 20, 11), target: (0, 5, 40), up: (0, 1, 0), fov_y: 70)",
            "",
            "",
        ),
        (
            "look_at(eye: (2, 4, 38), target: (27, 20, 11), up: (0, 1, 0), fov_y: 50)",
            "",
            r#"slots: { "reconstruct": "nearest" }"#,
        ),
        (
            "look_at(eye: (12, 10, 30), target: (0, 5, 42), up: (0, 1, 0), fov_y: 60)",
            "",
            "",
        ),
        (
            far,
            "",
            r#"slots: { "clip": "box" }, params: { "clip_high": [0.8, 1, 0.6] }"#,
        ),
    ];
    let stage = stage();
    for (number, (camera, source, image)) in cases.into_iter().enumerate() {
        stage.write("box.ron", graph(BOX, camera, source, image));
        stage.write("bricks.ron", graph(BRICKS, camera, source, image));
        for backend in adapters() {
            for rays in STAGES {
                let sets = [format!("image.stage={rays}")];
                let sets = sets.each_ref().map(String::as_str);
                let (whole, of_box) = draw(&stage, "box.ron", &sets, &backend);
                let (part, of_bricks) = draw(&stage, "bricks.ron", &sets, &backend);
                let error = compare_without_flip(&whole, &part).unwrap().max.error;
                let case = format!("{number} on {backend}, {rays}");
                assert!(error <= 1e-6, "{case}: {error:e}");
                assert!(of_bricks <= of_box, "{case}: {of_bricks} of {of_box}");
                // The block's bricks are 24 of 37, 16 of 29 and 16 of 43 voxels wide.
                if number == 0 {
                    assert!(2 * of_bricks < of_box, "{case}: {of_bricks} of {of_box}");
                }
            }
        }
    }
}

#[test]
fn it_follows_the_transfer_function() {
    let at = |at: f64, opacity: f64| {
        format!(
            "(points: [(at: {at}, color: (1, 1, 1), opacity: 0), (at: 1, color: (1, 1, 1), opacity: {opacity})])"
        )
    };
    let camera = "orbit(azimuth: 30, elevation: 20)";
    let stage = stage()
        .with("box.ron", graph(BOX, camera, "", ""))
        .with("bricks.ron", graph(BRICKS, camera, "", ""));
    for backend in adapters() {
        for rays in STAGES {
            let set = format!("image.stage={rays}");
            stage.write("transfer.ron", at(0.9, 0.5));
            let mut session = stage.open("bricks.ron", &[&set], &backend, SIZE).unwrap();
            session.draw().unwrap();
            // All of it, the block, and nothing.
            for (from, opacity) in [(0.02, 0.5), (0.4, 0.5), (0.4, 0.0)] {
                stage.write("transfer.ron", at(from, opacity));
                let file = stage.path().join("transfer.ron");
                let drawn = match session.apply(&Change::Files([file].into())) {
                    Ok(Outcome::Drawn(drawn)) => drawn.picture,
                    other => panic!("{other:?}"),
                };
                let (whole, _) = draw(&stage, "box.ron", &[&set], &backend);
                let error = compare_without_flip(&whole, &drawn).unwrap().max.error;
                assert!(
                    error <= 1e-6,
                    "{from}, {opacity} on {backend}, {rays}: {error:e}"
                );
            }
        }
    }
}

#[test]
fn what_shows_more_than_the_bricks_is_refused() {
    let camera = "orbit(azimuth: 30, elevation: 20)";
    let stage = stage().with("other.ron", TRANSFER);
    let refused = |graph: String, words: &str| {
        stage.write("graph.ron", graph);
        let backend = &adapters()[0];
        let session = stage.open("graph.ron", &[], backend, SIZE);
        let findings = session.and_then(|mut session| session.draw().map(|_| ()));
        let findings = findings.unwrap_err().to_string();
        assert!(
            findings.contains("not-covered") && findings.contains(words),
            "{words}: {findings}"
        );
    };
    for technique in ["mip", "isosurface", "average", "xray"] {
        let image = format!(r#"slots: {{ "technique": "{technique}" }}"#);
        refused(graph(BRICKS, camera, "", &image), technique);
    }
    let image = r#"slots: { "reconstruct": "catmull_rom" }"#;
    refused(graph(BRICKS, camera, "", image), "catmull_rom");
    refused(
        graph(
            BRICKS,
            camera,
            "",
            r#"params: { "volume_storage": "r16float" }"#,
        ),
        "volume_storage",
    );
    let other = BRICKS.replace(r#""t" "#, r#""o" "#);
    let other = graph(&other, camera, "", "").replace(
        "sources: {",
        r#"sources: { "o": transfer(path: "other.ron"), "#,
    );
    refused(other, "transfer");
    let limit = graph(BRICKS, camera, "", "")
        .replace(r#""transfer": "t", "rays""#, r#""rays""#)
        .replace(r#", "behind": "behind" }"#, " }")
        .replace(r#""raycast""#, r#""fetch_only""#)
        .replace(r#", "samples": "image.samples""#, "");
    refused(limit, "proxy_box");
}
