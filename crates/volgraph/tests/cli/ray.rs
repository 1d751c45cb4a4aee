//! `volgraph ray`.

use super::Scratch;

/// Even matter in a box, seen along z.
const GRAPH: &str = r#"(
    sources: {
        "volume": analytic(field: "constant", dims: (16, 16, 16)),
        "colors": transfer(path: "transfer.ron"),
    },
    camera: orbit(azimuth: 0, elevation: 0),
    nodes: {
        "box":   (kind: "proxy_box", in: { "volume": "volume" }),
        "image": (kind: "raycast", in: { "volume": "volume", "transfer": "colors", "rays": "box" }),
    },
    outputs: { "color": "image.color" },
)"#;

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("graph.ron", GRAPH);
    scratch.write(
        "transfer.ron",
        "(color: (1, 0.5, 0.25), extinction: [(0, 0.1)])",
    );
    scratch
}

#[test]
fn it_tells_segments_sums_and_the_reference_and_plots_them() {
    let scratch = scratch();
    let args = ["ray", "graph.ron", "--size", "9x9", "--pixel", "4,4"];
    let json = scratch.run(&[&args[..], &["--json", "-o", "ray.svg"]].concat());
    assert_eq!(json.code, Some(0), "{}", json.stderr);
    let value: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    // 16 voxels of extinction 0.1.
    let opacity = 1.0 - (-1.6_f64).exp();
    for name in ["sum", "color", "over", "picture"] {
        let red = value[name][0].as_f64().unwrap();
        assert!((red - opacity).abs() < 1e-4, "{name}: {red}");
    }
    let reference = value["reference"]["color"][0].as_f64().unwrap();
    assert!((reference - opacity).abs() < 1e-8, "{reference}");
    assert_eq!(value["segments"].as_array().unwrap().len(), 16);
    assert_eq!(value["segments"][3]["status"], "taken");
    let svg = std::fs::read_to_string(scratch.path().join("ray.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("16 taken"), "{svg}");
    let text = scratch.run(&args);
    assert_eq!(text.code, Some(0), "{}", text.stderr);
    for part in [
        "16 taken",
        "sum of segments",
        "probe at the hit",
        "gradient",
    ] {
        assert!(text.stdout.contains(part), "{part}: {}", text.stdout);
    }
    assert!(!text.stdout.contains("-0.0000"), "{}", text.stdout);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let scratch = scratch();
    let of = |args: &[&str]| scratch.run(&[&["ray", "graph.ron", "--size", "9x9"], args].concat());
    for (args, code, word) in [
        (&["--pixel", "9,0"][..], 1, "pixel-outside"),
        (&["--pixel", "4,4", "-o", "ray.png"], 1, "drawing-format"),
        (&["--pixel", "4,4", "-o", "none/ray.svg"], 1, "folder"),
        (&["--pixel", "4"], 2, "COLUMN,ROW"),
        (&["--pixel=-1,4"], 2, "COLUMN,ROW"),
        (&["--pixel", "nan,4"], 2, "COLUMN,ROW"),
        (&[], 2, "--pixel"),
    ] {
        let run = of(args);
        assert_eq!(run.code, Some(code), "{args:?}: {}", run.stderr);
        assert!(run.stderr.contains(word), "{args:?}: {}", run.stderr);
    }
}
