//! Charts: the files are there, with a row and a point for each method; what is refused is told.

use crate::Scratch;

const GRAPH: &str = r#"// A <ball> in mist.
(
    sources: { "volume": analytic(field: "sphere", dims: (12, 12, 12), type: "uint8"), "colors": transfer(path: "t.ron") },
    nodes: { "background": (kind: "background"),
             "box": (kind: "proxy_box", in: { "volume": "volume" }),
             "image": (kind: "raycast", in: { "volume": "volume", "transfer": "colors", "rays": "box", "behind": "background" },
                       slots: { "light": "unlit", "classify": "post" }) },
    outputs: { "color": "image.color" },
)"#;

const TRANSFER: &str = r#"(domain: normalised, points: [
    (at: 0.0, color: (1, 1, 1), opacity: 0.0), (at: 0.5, color: (0.8, 0.1, 0.05), opacity: 0.5), (at: 1.0, color: (0.05, 0.1, 0.6), opacity: 0.1),
])"#;

/// Two steps of each classification, all else the same.
const METHODS: &str = "step=1,2 traverse=uniform reconstruct=trilinear stage=compute volume_storage=r16float early_termination=0";

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("ball.ron", GRAPH);
    scratch.write("t.ron", TRANSFER);
    scratch
}

fn chart(scratch: &Scratch, methods: &str, more: &[&str]) -> serde_json::Value {
    let mut args = vec![
        "chart",
        "ball.ron",
        "-o",
        "out",
        "--size",
        "16x12",
        "--no-cache",
    ];
    args.extend([
        "--frames",
        "1",
        "--first-frames",
        "1",
        "--json",
        "--methods",
        methods,
    ]);
    args.extend(more);
    scratch.run(&args).ok().json()
}

fn text(scratch: &Scratch, file: &str) -> String {
    std::fs::read_to_string(scratch.path().join(file)).unwrap()
}

#[test]
fn a_chart_has_a_row_a_point_and_pictures_for_each_method() {
    let scratch = scratch();
    let json = chart(
        &scratch,
        &format!("classify=post,preintegrated_2d {METHODS}"),
        &[],
    );
    let survey = &json["charts"][0]["survey"];
    // The software raycaster draws the post-classified ones as well; only the table has a lookup.
    assert_eq!(survey["product"], 8);
    assert_eq!(survey["measured"].as_array().unwrap().len(), 8, "{survey}");
    assert_eq!(json["charts"][0]["truth"], "reference");
    assert!(json["charts"][0]["truth_seconds"].as_f64().unwrap() > 0.0);
    let table = text(&scratch, "out/ball.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 1 + 8);
    assert!(rows[0].starts_with(
        "renderer,classify,traverse,reconstruct,volume_storage,stage,lookup,step,early_termination,front,"
    ));
    assert!(rows[1].starts_with("device,post,uniform,trilinear,r16float,compute,,1.0,0.0,"));
    let column = |row: &str, name: &str| -> String {
        let at = rows[0].split(',').position(|it| it == name).unwrap();
        row.split(',').nth(at).unwrap().to_owned()
    };
    // Both renderers have the error of the method alone.
    for step in ["1.0", "2.0"] {
        let of = |renderer: &str| -> f64 {
            let is_it = |row: &&&str| {
                ["renderer", "classify", "step"].map(|name| column(row, name))
                    == [renderer, "post", step]
            };
            column(rows.iter().find(is_it).unwrap(), "rmse")
                .parse()
                .unwrap()
        };
        let (device, software) = (of("device"), of("software"));
        assert!(
            (device - software).abs() < 1e-4,
            "{step}: {device} {software}"
        );
    }
    let chart = text(&scratch, "out/ball.svg");
    assert!(chart.contains("currentColor") && !chart.contains("#010101"));
    let page = text(&scratch, "out/index.html");
    assert_eq!(page.matches("class=\"hit\"").count(), 8);
    assert!(page.contains("early termination") && page.contains("A &lt;ball&gt; in mist"));
    // Nothing is read from elsewhere.
    assert!(
        !page
            .replace("http://www.w3.org/2000/svg", "")
            .contains("http")
    );
    for number in 1..=8 {
        for file in [
            format!("out/ball/{number:03}.png"),
            format!("out/ball/{number:03}-error.png"),
        ] {
            let picture = scratch.picture(&file);
            assert_eq!((picture.width, picture.height), (16, 12), "{file}");
        }
    }
    assert!(scratch.path().join("out/ball/truth.png").is_file());
}

#[test]
fn rows_of_other_renderers_that_are_not_shown_are_told() {
    let scratch = scratch();
    let head = "peer\tmode\tvolume\tstep_vox\tmedian_ms\tmin_ms\tmax_ms\tn\trmse8_core";
    let rows = "one\tcomposite\tml\t1\t42\t40\t50\t9\t0.8\ntwo\tcomposite\tml\t1\t\t\t\t\t";
    scratch.write("peers.tsv", format!("{head}\n{rows}\n"));
    // A ball is none of the scenes that others drew.
    let json = chart(
        &scratch,
        &format!("classify=post {METHODS}"),
        &["--peers", "peers.tsv"],
    );
    let left_out = serde_json::json!([
        { "rows": 1, "why": "without a time or an error" },
        { "rows": 1, "why": "not of this graph's scene" },
    ]);
    assert_eq!(json["charts"][0]["peers"], serde_json::json!([]));
    assert_eq!(json["charts"][0]["peers_left_out"], left_out);
    let words = "1 row without a time or an error, 1 row not of this graph's scene";
    let page = text(&scratch, "out/index.html").replace("&#39;", "'");
    assert!(page.contains(words), "{page}");
}

#[test]
fn refused_methods_are_listed_with_the_reason() {
    let scratch = scratch();
    scratch.write("broken.wgsl", "fn classify_segment() { return nothing; }\n");
    let json = chart(
        &scratch,
        &format!("renderer=device classify=post,./broken.wgsl {METHODS}"),
        &[],
    );
    let survey = &json["charts"][0]["survey"];
    assert_eq!(survey["measured"].as_array().unwrap().len(), 2);
    let refused = survey["refused"].as_array().unwrap();
    assert_eq!(refused.len(), 2, "{refused:?}");
    let table = text(&scratch, "out/ball.csv");
    assert_eq!(table.lines().count(), 1 + 4);
    assert!(text(&scratch, "out/index.html").contains("2 methods that the scene does not take"));
    for (methods, code) in [
        ("classfy=post", "unknown-setting"),
        ("classify=past", "unknown-choice"),
    ] {
        let args = ["chart", "ball.ron", "-o", "out", "--methods", methods];
        scratch.run(&args).refused(&[code]);
    }
}

#[test]
fn what_the_reference_does_not_cover_is_held_against_a_fine_step() {
    let scratch = scratch();
    let methods = format!("classify=post {METHODS}");
    // Shadows inside of a volume.
    let shadowed = [
        "--set",
        "image.slots.light=phong",
        "--set",
        "image.slots.shadow=light_volume",
    ];
    // A second graph comes with an index of both.
    scratch.write("other.ron", GRAPH);
    let json = chart(
        &scratch,
        &methods,
        &[&shadowed[..], &["other.ron"]].concat(),
    );
    assert_eq!(json["charts"][1]["truth"], "fine");
    for file in [
        "index.html",
        "ball.html",
        "other.html",
        "ball.csv",
        "other.svg",
    ] {
        assert!(scratch.path().join("out").join(file).is_file(), "{file}");
    }
    // Against itself at a fine step a shorter step is nearer.
    let measured = &json["charts"][0]["survey"]["measured"];
    let rmse = |at: usize| measured[at]["errors"]["rmse"].as_f64().unwrap();
    assert!(
        rmse(0) < rmse(1) && rmse(0) > 0.0,
        "{} {}",
        rmse(0),
        rmse(1)
    );
    let args = [
        "chart",
        "ball.ron",
        "-o",
        "out",
        "--size",
        "16x12",
        "--truth",
        "reference",
    ];
    scratch
        .run(&[&args[..], &shadowed[..]].concat())
        .refused(&["not-covered"]);
}
