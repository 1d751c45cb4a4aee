//! What the commands print, on standard output, for people and for programs.

use volgraph::Picture;
use volgraph_picture::SaveOptions;

use crate::{SPHERE, Scratch, TRANSFER, graph};

fn picture(scratch: &Scratch, name: &str, value: f32) {
    let mut picture = Picture::from_color(20, 10, vec![[0.25, 0.5, 0.75, 1.0]; 200]).unwrap();
    picture.color[25][1] += value;
    let _ = picture
        .save(&scratch.path().join(name), SaveOptions::default())
        .unwrap();
}

#[test]
fn compare_tells_what_differs_and_holds_bounds() {
    let scratch = Scratch::new();
    picture(&scratch, "a.exr", 0.0);
    picture(&scratch, "b.exr", 0.125);
    let same = scratch.run(&["compare", "a.exr", "a.exr", "--json"]);
    assert_eq!(
        (same.code, &same.json()["rmse"]),
        (Some(0), &serde_json::json!(0.0))
    );
    let run = scratch.run(&["compare", "b.exr", "a.exr", "--json"]);
    let json = run.json();
    assert_eq!(run.code, Some(0), "a difference is no error");
    assert_eq!(
        json["max"],
        serde_json::json!({ "error": 0.125, "x": 5, "y": 1, "channel": "green" })
    );
    // One component of 800 is off by 1/8.
    let rmse = json["rmse"].as_f64().unwrap();
    assert!((rmse - 0.125 / 800_f64.sqrt()).abs() < 1e-12, "{rmse}");
    assert!(json["flip"].as_f64().unwrap() > 0.0);
    let text = scratch.run(&["compare", "b.exr", "a.exr"]);
    assert!(
        text.stdout.contains("rmse") && text.stdout.contains("Green at (5, 1)"),
        "{}",
        text.stdout
    );
    for (bound, value, code) in [
        ("--max-rmse", "0.01", 0),
        ("--max-rmse", "0.004", 1),
        ("--max-error", "0.125", 0),
        ("--max-error", "0.12", 1),
    ] {
        let run = scratch.run(&["compare", "b.exr", "a.exr", bound, value]);
        assert_eq!(run.code, Some(code), "{bound} {value}: {run:?}");
        assert_eq!(
            run.stderr.contains(&format!("error[over{}", &bound[1..])),
            code == 1,
            "{}",
            run.stderr
        );
    }
}

#[test]
fn pictures_that_cannot_be_compared_are_named() {
    let scratch = Scratch::new();
    picture(&scratch, "a.exr", 0.0);
    scratch.write("b.png", "no picture");
    let small = Picture::from_color(1, 1, vec![[0.0; 4]]).unwrap();
    let _ = small
        .save(&scratch.path().join("small.png"), SaveOptions::default())
        .unwrap();
    picture(&scratch, "nan.exr", f32::NAN);
    for (other, code, place) in [
        ("b.png", "not-a-picture", "b.png"),
        ("no.png", "io", "no.png"),
        ("small.png", "picture-sizes", "small.png"),
        ("nan.exr", "not-a-number", "nan.exr"),
    ] {
        let run = scratch.run(&["compare", "a.exr", other]);
        assert_eq!(run.code, Some(1), "{other}");
        assert!(
            run.stderr.contains(&format!("error[{code}]")) && run.stderr.contains(place),
            "{}",
            run.stderr
        );
    }
}

#[test]
fn info_tells_dimensions_placement_and_statistics() {
    let scratch = Scratch::new();
    let values = [0.0_f32, 1.0, 2.0, f32::NAN, 4.0, f32::INFINITY, 6.0, 7.0];
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    scratch.write("v_2x2x2_float32.raw", bytes);
    let json = scratch
        .run(&["info", "v_2x2x2_float32.raw", "--json"])
        .json();
    assert_eq!(json["dims"], serde_json::json!([2, 2, 2]));
    assert_eq!(
        (&json["min"], &json["max"]),
        (&serde_json::json!(0.0), &serde_json::json!(7.0))
    );
    assert_eq!(
        (&json["nan_count"], &json["positive_infinity_count"]),
        (&serde_json::json!(1), &serde_json::json!(1))
    );
    assert!((json["mean"].as_f64().unwrap() - 20.0 / 6.0).abs() < 1e-12);
    assert_eq!(
        (&json["format"], json["digest"].as_str().unwrap().len()),
        (&serde_json::json!("raw"), 64)
    );
    let text = scratch.run(&["info", "v_2x2x2_float32.raw"]);
    for part in [
        "2 x 2 x 2",
        "float32",
        "+x +y +z",
        "1 not a number",
        "range        0 to 7",
    ] {
        assert!(text.stdout.contains(part), "{part}: {}", text.stdout);
    }
    let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 2\nspace: left-posterior-superior\n\
                  space directions: (0.6,0.8,0) (-0.8,0.6,0) (0,0,2)\nencoding: raw\n\n";
    scratch.write("o.nrrd", [header.as_bytes(), &[1, 2]].concat());
    let oblique = scratch.run(&["info", "o.nrrd"]);
    assert!(
        oblique.stdout.contains("oblique") && oblique.stdout.contains("-0.800000"),
        "{}",
        oblique.stdout
    );
    assert_eq!(
        scratch.run(&["info", "o.nrrd", "--json"]).json()["is_oblique"],
        true
    );
    // Options for a file whose name says nothing.
    scratch.write("x.bin", [0, 1, 0, 2]);
    let args = [
        "info",
        "x.bin",
        "--dims",
        "2x1x1",
        "--type",
        "uint16",
        "--big-endian",
        "--json",
    ];
    assert_eq!(scratch.run(&args).json()["max"], 2.0);
    let run = scratch.run(&["info", "x.bin"]);
    assert!(
        run.code == Some(1) && run.stderr.contains("error[volume-"),
        "{run:?}"
    );
}

#[test]
fn nodes_lists_ports_parameters_and_choices() {
    let scratch = Scratch::new();
    scratch.write(
        "mine/slot/light/flat.wgsl",
        "// How a point is lit: flatly. More of it.\n#import \"lib/classified.wgsl\"\n\
         struct Params {\n    /// How flat. @default 0.5 @range 0 1\n    flatness: f32,\n}\n\
         fn light_segment(classified: Classified, segment: Segment, ray: Ray) -> vec3f {\n\
             return classified.color * params.flatness;\n}\n",
    );
    let json = scratch
        .run(&["nodes", "raycast", "--shaders", "mine", "--json"])
        .json();
    assert_eq!(json["sources"], serde_json::json!([]));
    let node = &json["nodes"][0];
    let named = |list: &serde_json::Value, name: &str| {
        list.as_array()
            .unwrap()
            .iter()
            .find(|value| value["name"] == name)
            .unwrap_or_else(|| panic!("{name}"))
            .clone()
    };
    assert_eq!(named(&node["inputs"], "volume")["requirement"], "required");
    assert_eq!(
        named(&node["inputs"], "gradient_volume")["made_by"],
        "gradient"
    );
    assert_eq!(named(&node["outputs"], "color")["type"], "color");
    let light = named(&node["slots"], "light");
    let flat = named(&light["choices"], "flat");
    assert_eq!(
        (&light["default"], &flat["doc"]),
        (
            &serde_json::json!("unlit"),
            &serde_json::json!("How a point is lit: flatly.")
        )
    );
    assert_eq!(
        named(&flat["params"], "flatness")["range"],
        serde_json::json!([0.0, 1.0])
    );
    assert!(
        named(&node["slots"], "behind")["is_fixed"]
            .as_bool()
            .unwrap()
    );
    let text = scratch.run(&["nodes"]);
    for part in [
        "node background",
        "node proxy_box",
        "source analytic",
        "param step = 1.0",
        "slot  technique = dvr",
    ] {
        assert!(text.stdout.contains(part), "{part}");
    }
    let run = scratch.run(&["nodes", "raycats"]);
    assert!(
        run.code == Some(1) && run.stderr.contains("did you mean `raycast`"),
        "{run:?}"
    );
}

#[test]
fn plan_prints_text_json_and_a_drawing() {
    let scratch = Scratch::new();
    scratch.write("t.ron", TRANSFER);
    scratch.write("g.ron", graph(SPHERE));
    let text = scratch.run(&["plan", "g.ron"]);
    assert!(
        text.stdout.contains("(raycast)") && text.stdout.contains("convention"),
        "{}",
        text.stdout
    );
    let json = scratch
        .run(&["plan", "g.ron", "--json", "--size", "64x32"])
        .json();
    assert_eq!(json["size"], serde_json::json!([64, 32]));
    assert_eq!(json["outputs"]["color"], "image.color");
    let dot = scratch.run(&["plan", "g.ron", "--dot"]).stdout;
    assert!(
        dot.starts_with("digraph plan {") && dot.trim_end().ends_with('}'),
        "{dot}"
    );
    assert!(dot.contains("\"box\" -> \"image\""), "{dot}");
    // A pipe gets no colours and no progress bars.
    assert!(!text.stdout.contains('\u{1b}') && !text.stderr.contains('\u{1b}'));
}

#[test]
fn adapters_are_listed_for_programs_too() {
    let run = Scratch::new().run(&["adapters", "--json"]);
    assert_eq!(run.code, Some(0));
    assert!(run.json().is_array());
}
