//! The gallery: every ready graph is drawn, and the page shows what came of it.

use crate::{Scratch, root};

/// The ready graphs that need no file: those that lie in `graphs` itself.
fn names() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(root().join("graphs"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn every_graph_without_a_scan_is_drawn_with_no_file_from_outside() {
    let scratch = Scratch::new();
    let run = scratch
        .run(&[
            "gallery", "-o", "out", "--size", "20x16", "--frames", "1", "--json",
        ])
        .ok();
    let json = run.json();
    let drawn: Vec<&str> = json["exhibits"]
        .as_array()
        .unwrap()
        .iter()
        .map(|exhibit| exhibit["name"].as_str().unwrap())
        .collect();
    assert_eq!(drawn, names());
    assert_eq!(json["failed"], serde_json::json!([]));
    // What is left out is told, with what it needs.
    let left_out = json["left_out"].as_array().unwrap();
    assert!(left_out.iter().any(|name| name == "tooth"), "{left_out:?}");
    assert!(
        run.stderr
            .contains("tooth is left out: it needs tooth_103x94x161_uint8.raw.gz")
    );
    let page = std::fs::read_to_string(scratch.path().join("out/index.html")).unwrap();
    let list = std::fs::read_to_string(scratch.path().join("out/gallery.md")).unwrap();
    let adapter = json["adapter"].as_str().unwrap();
    assert!(page.contains(adapter), "{adapter}");
    for name in &drawn {
        let picture = scratch.picture(&format!("out/{name}.png"));
        assert_eq!((picture.width, picture.height), (20, 16), "{name}");
        let colors = &picture.color;
        assert!(
            colors.iter().any(|color| color != &colors[0]),
            "{name} is empty"
        );
        assert!(
            page.contains(&format!("src=\"{name}.png\""))
                && list.contains(&format!("({name}.png)"))
        );
    }
}

#[test]
fn graphs_are_chosen_by_name_and_draw_the_volume_that_is_given() {
    let scratch = Scratch::new();
    // A ball in bytes, as scans have them.
    let voxels: Vec<u8> = (0..20_u32.pow(3))
        .map(|i| {
            let [x, y, z] = [i % 20, i / 20 % 20, i / 400].map(|n| f64::from(n) - 9.5);
            (255.0 * (1.2 - (x * x + y * y + z * z).sqrt() / 9.5).clamp(0.0, 1.0)) as u8
        })
        .collect();
    scratch.write("ball_20x20x20_uint8.raw", voxels);
    let names = names();
    let mut args = vec![
        "gallery", "-o", "out", "--size", "16x16", "--frames", "1", "--json",
    ];
    args.extend(["--volume", "ball_20x20x20_uint8.raw"]);
    args.extend(names.iter().map(String::as_str));
    let json = scratch.run(&args).ok().json();
    assert_eq!(
        json["exhibits"].as_array().unwrap().len(),
        names.len(),
        "{json}"
    );
    scratch
        .run(&["gallery", "-o", "out", "quickstat"])
        .refused(&["unknown-graph"]);
    // A graph with two volumes, none of them named `volume`.
    let two = r#"(
    sources: { "a": analytic(field: "sphere"), "b": analytic(field: "torus") },
    nodes: { "box": (kind: "proxy_box", in: { "volume": "a" }),
             "image": (kind: "raycast", in: { "volume": "a", "rays": "box" }, slots: { "technique": "mip" }) },
    outputs: { "color": "image.color" },
)"#;
    scratch.write("two.ron", two);
    scratch
        .run(&["plan", "two.ron", "--volume", "ball_20x20x20_uint8.raw"])
        .refused(&["ambiguous-volume"]);
    scratch
        .run(&["plan", "two.ron", "--volume", "b=ball_20x20x20_uint8.raw"])
        .ok();
}
