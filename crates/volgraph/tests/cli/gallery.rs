//! The gallery: what is asked for is drawn, and the page shows what came of it. That every ready graph can be drawn, and is not
//! empty, is a test of the renderer (`agreement`), and no work for this one.

use volgraph::truth::plan_without_device;
use volgraph::{Overrides, Picture, Scene, ShaderFolders};

use crate::{Run, Scratch, graphs_in, root};

/// A graph of each kind: composited, a projection, a surface; and two volumes.
const SOME: [&str; 4] = ["clip_volume", "isosurface", "mip", "quickstart"];

fn gallery(scratch: &Scratch, more: &[&str]) -> Run {
    let args = ["gallery", "--size", "20x16", "--frames", "1", "--json"];
    scratch.run(&[&args[..], more].concat()).ok()
}

fn drawn(run: &Run) -> Vec<String> {
    let json = run.json();
    assert_eq!(json["failed"], serde_json::json!([]));
    let exhibits = json["exhibits"].as_array().unwrap();
    let names = exhibits.iter().map(|it| it["name"].as_str().unwrap());
    names.map(str::to_owned).collect()
}

#[test]
fn graphs_are_drawn_by_name_and_what_is_left_out_is_told() {
    let scratch = Scratch::new();
    let run = gallery(&scratch, &[&["-o", "out", "tooth"], &SOME[..]].concat());
    assert_eq!(drawn(&run), SOME);
    let json = run.json();
    // What is left out is told, with what it needs.
    assert_eq!(json["left_out"], serde_json::json!(["tooth"]));
    assert!(
        run.stderr
            .contains("tooth is left out: it needs tooth_103x94x161_uint8.raw.gz")
    );
    let page = std::fs::read_to_string(scratch.path().join("out/index.html")).unwrap();
    let list = std::fs::read_to_string(scratch.path().join("out/gallery.md")).unwrap();
    let adapter = json["adapter"].as_str().unwrap();
    assert!(page.contains(adapter), "{adapter}");
    for name in SOME {
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
    scratch
        .run(&["gallery", "-o", "out", "quickstat"])
        .refused(&["unknown-graph"]);
}

/// A ball in bytes, as scans have them; so many voxels aside of the middle.
fn ball(scratch: &Scratch, name: &str, aside: f64) -> String {
    let voxels: Vec<u8> = (0..20_u32.pow(3))
        .map(|i| {
            let [x, y, z] = [i % 20, i / 20 % 20, i / 400].map(|n| f64::from(n) - 9.5);
            let distance = ((x - aside).powi(2) + y * y + (z - aside).powi(2)).sqrt();
            (255.0 * (1.2 - distance / 8.0).clamp(0.0, 1.0)) as u8
        })
        .collect();
    let file = format!("{name}_20x20x20_uint8.raw");
    scratch.write(&file, voxels);
    file
}

#[test]
fn a_volume_that_is_given_is_the_one_that_is_seen() {
    let scratch = Scratch::new();
    // Which is where in the picture tells them apart; the ready graphs' own fields are of other forms.
    let balls = [("low", -4.0), ("high", 4.0)].map(|(name, aside)| ball(&scratch, name, aside));
    let given = [None, Some(&balls[0]), Some(&balls[1])];
    let pictures = given.map(|volume| {
        let folder = volume.map_or("own".to_owned(), |file| format!("of_{file}"));
        let volume = volume.map_or(vec![], |file| vec!["--volume", file.as_str()]);
        let more = [&["-o", folder.as_str()], &SOME[1..], &volume];
        assert_eq!(drawn(&gallery(&scratch, &more.concat())), SOME[1..]);
        let of = |name: &&str| scratch.picture(&format!("{folder}/{name}.png"));
        SOME[1..].iter().map(of).collect::<Vec<Picture>>()
    });
    for (at, name) in SOME[1..].iter().enumerate() {
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            let [a, b] = [&pictures[a][at], &pictures[b][at]];
            let pairs = a.color.iter().zip(&b.color);
            // By more than the rounding of a picture's bytes. A ball is some 11 of the 20 voxels wide and 4 of the 20 pixels:
            // two in other places cover more pixels than these.
            let apart = pairs.filter(|(a, b)| (0..3).any(|i| (a[i] - b[i]).abs() > 0.02));
            assert!(apart.count() >= 12, "{name}: the volume is not seen");
        }
    }
}

#[test]
fn every_graph_takes_a_volume_that_is_given() {
    let scratch = Scratch::new();
    let file = ball(&scratch, "ball", 0.0);
    for name in graphs_in("graphs") {
        let overrides = Overrides {
            volumes: vec![(String::new(), scratch.path().join(&file))],
            ..Overrides::default()
        };
        let path = root().join(format!("graphs/{name}.ron"));
        let folders = ShaderFolders::default();
        let registry = volgraph::registry();
        let scene = Scene::load(&path, &overrides, &folders, registry, &volgraph::NoProgress);
        let plan = scene.and_then(|scene| plan_without_device(&scene, [16, 16]));
        let text = plan
            .unwrap_or_else(|findings| panic!("{name}: {findings}"))
            .to_text();
        assert!(
            text.contains("ball 20x20x20 uint8"),
            "{name} does not draw it: {text}"
        );
    }
    // A graph with two volumes, none of them named `volume`.
    let two = r#"(
    sources: { "a": analytic(field: "sphere"), "b": analytic(field: "torus") },
    nodes: { "box": (kind: "proxy_box", in: { "volume": "a" }),
             "image": (kind: "raycast", in: { "volume": "a", "rays": "box" }, slots: { "technique": "mip" }) },
    outputs: { "color": "image.color" },
)"#;
    scratch.write("two.ron", two);
    scratch
        .run(&["plan", "two.ron", "--volume", &file])
        .refused(&["ambiguous-volume"]);
    scratch
        .run(&["plan", "two.ron", "--volume", &format!("b={file}")])
        .ok();
}
