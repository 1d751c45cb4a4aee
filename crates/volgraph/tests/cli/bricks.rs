//! Volumes in bricks by the command line: the pyramid is built, drawn from, and held against the reference level by level.

use crate::Scratch;

/// A ball of 48³ bytes in a raw file, and a graph that draws it in bricks.
fn scratch() -> Scratch {
    let scratch = Scratch::new();
    let at = |i: u32| (f64::from(i) - 23.5) / 24.0;
    let mut voxels = Vec::new();
    for z in 0..48 {
        for y in 0..48 {
            for x in 0..48 {
                let r = (at(x).powi(2) + at(y).powi(2) + at(z).powi(2)).sqrt();
                voxels.push((255.0 * (1.0 - r).clamp(0.0, 1.0)) as u8);
            }
        }
    }
    scratch.write("ball_48x48x48_uint8.raw", voxels);
    scratch.write(
        "g.ron",
        r##"(
    sources: {
        "ball": bricks(path: "ball_48x48x48_uint8.raw"),
        "t": transfer(text: "(domain: data, color: [(0, \"#204080\"), (255, \"#ffffff\")], opacity: [(60, 0), (200, 0.2)])"),
    },
    nodes: {
        "box":   (kind: "proxy_box", in: { "volume": "ball" }),
        "image": (kind: "raycast", in: { "volume": "ball", "transfer": "t", "rays": "box" },
                  slots: { "gradient": "central" }, params: { "early_termination": 0.0 }),
    },
    outputs: { "color": "image.color" },
)"##,
    );
    scratch
}

const EDGE: [&str; 2] = ["--edge", "16"];

#[test]
fn a_pyramid_is_built_drawn_and_measured() {
    let scratch = scratch();
    let without = scratch.run(&["render", "g.ron", "-o", "a.png", "--size", "64x64"]);
    assert_ne!(without.code, Some(0));
    let told = without.stderr;
    assert!(
        told.contains("volgraph pyramid") && told.contains("g.ron"),
        "{told}"
    );
    scratch
        .run(&[&["pyramid", "ball_48x48x48_uint8.raw"][..], &EDGE].concat())
        .ok();
    let drawn = scratch
        .run(&[
            "render", "g.ron", "-o", "a.png", "--size", "64x64", "--json",
        ])
        .ok()
        .json();
    let nodes = drawn["frame"]["nodes"].as_array().unwrap();
    let about = nodes
        .iter()
        .find_map(|node| node["about"].as_str())
        .unwrap();
    assert!(about.contains("bricks of levels"), "{about}");
    assert_eq!(
        drawn["frame"]["progress"]["ready"],
        drawn["frame"]["progress"]["wanted"]
    );

    let levels = scratch
        .run(&[
            "levels",
            "g.ron",
            "--size",
            "48x48",
            "--crop",
            "8,8,8..40,40,40",
            "--json",
        ])
        .ok()
        .json();
    let levels = levels["levels"].as_array().unwrap();
    let number = |level: usize, key: &str| levels[level][key].as_f64().unwrap();
    assert_eq!(levels.len(), 2);
    assert_eq!(levels[1]["dims"], serde_json::json!([16, 16, 16]));
    // The finest level is as wrong as the step makes it, the next one more so.
    assert!(number(0, "rmse") < 1e-3, "{levels:?}");
    assert!(number(1, "rmse") > 2.0 * number(0, "rmse"), "{levels:?}");
    assert_eq!(number(0, "scalar_rms"), 0.0);
    assert!(number(1, "scalar_rms") > 0.1);

    let text = scratch
        .run(&["levels", "g.ron", "--size", "32x32"])
        .ok()
        .stdout
        .clone();
    assert!(
        text.contains("float64 reference of level 0") && text.lines().count() > 3,
        "{text}"
    );
    let beyond = scratch
        .run(&["levels", "g.ron", "--crop", "0,0,0..99,9,9"])
        .stderr;
    assert!(beyond.contains("inside"), "{beyond}");
    let whole = scratch.run(&["levels", "quickstart"]).stderr;
    assert!(whole.contains("no-bricks"), "{whole}");
}
