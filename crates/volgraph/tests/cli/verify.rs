//! `volgraph verify`: orders as theory has them, shaders that break them, and pictures rendered again.

mod layers;
mod untold;

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::{Run, Scratch, root};

/// What a study of one slot's choice must come to.
struct Case {
    /// The arguments that choose.
    args: &'static [&'static str],
    /// The axis and the quantity that are looked at.
    of: (&'static str, &'static str),
    /// What theory says.
    order: f64,
}

const fn case(args: &'static [&'static str], of: (&'static str, &'static str), order: f64) -> Case {
    Case { args, of, order }
}

const COLOR: (&str, &str) = ("step", "colour");
const DEPTH: (&str, &str) = ("step", "depth");

/// Orders of theory: quadratures by their degree; of pre-integration the field between the ends is what is linear; of
/// a hit at a segment's end the step itself, of a linear one its square. FOLDER is where the tests' own shaders are.
const CASES: &[Case] = &[
    case(&["--slot", "classify=post"], COLOR, 2.0),
    case(&["--slot", "classify=FOLDER/ends.wgsl"], COLOR, 1.0),
    case(&["--slot", "classify=preintegrated_2d"], COLOR, 2.0),
    case(&["--slot", "classify=FOLDER/unattenuated.wgsl"], COLOR, 1.0),
    case(&["--slot", "classify=preintegrated_3d"], COLOR, 2.0),
    case(&["--slot", "classify=integral_1d"], COLOR, 2.0),
    case(&["--slot", "classify=gauss2"], COLOR, 4.0),
    case(&["--slot", "classify=simpson"], COLOR, 4.0),
    case(&["--slot", "classify=second_order"], COLOR, 4.0),
    case(
        &[
            "--slot",
            "technique=isosurface",
            "--set",
            "image.refinement=none",
        ],
        DEPTH,
        1.0,
    ),
    case(
        &[
            "--slot",
            "technique=isosurface",
            "--set",
            "image.refinement=linear",
        ],
        DEPTH,
        2.0,
    ),
    case(
        &["--slot", "reconstruct=trilinear", "--orders=grid"],
        ("grid", "colour"),
        2.0,
    ),
];

/// How far a measured order may be from that of theory.
const TOLERANCE: f64 = 0.15;

fn verify(scratch: &Scratch, args: &[&str]) -> Run {
    scratch.run(&[&["verify", "--json", "--size", "32x32"], args].concat())
}

fn quantity(run: &Run, (axis, name): (&str, &str)) -> Value {
    let json = run.json();
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let studies = list(&json["studies"]);
    let study = studies.iter().find(|study| study["axis"] == axis).unwrap();
    assert_eq!(study["against"], "reference", "{run:?}");
    let quantities = list(&study["quantities"]);
    let found = quantities.iter().find(|quantity| quantity["name"] == name);
    found.unwrap().clone()
}

#[test]
fn orders_are_those_of_theory_and_those_declared() {
    let scratch = Scratch::new();
    let folder = root().join("tests/shaders/slot/classify");
    for case in CASES {
        let args: Vec<String> = case
            .args
            .iter()
            .map(|arg| arg.replace("FOLDER", &folder.display().to_string()))
            .collect();
        let run = verify(
            &scratch,
            &args.iter().map(String::as_str).collect::<Vec<_>>(),
        );
        assert_eq!(run.code, Some(0), "{args:?}: {run:?}");
        let quantity = quantity(&run, case.of);
        let order = quantity["order"].as_f64().unwrap();
        eprintln!("{args:?}: {order:.3}");
        assert!(
            (order - case.order).abs() <= TOLERANCE,
            "{args:?}: {quantity}"
        );
        assert_eq!(quantity["declared"]["order"], case.order, "{args:?}");
    }
}

/// A shader of the repository with something replaced in it.
fn planted(scratch: &Scratch, file: &str, replace: &[(&str, &str)], name: &str) -> String {
    let mut text = fs::read_to_string(root().join("shaders").join(file)).unwrap();
    for (what, by) in replace {
        assert!(text.contains(what), "{what} is not in {file}");
        text = text.replace(what, by);
    }
    let path = Path::new("slot")
        .join(Path::new(file).parent().unwrap())
        .join(name);
    scratch
        .write(path.to_str().unwrap(), text)
        .display()
        .to_string()
}

#[test]
fn shaders_that_lose_their_order_fail() {
    let scratch = Scratch::new();
    let post = "slot/classify/post.wgsl";
    let dropped = planted(
        &scratch,
        "slot/technique/dvr.wgsl",
        &[
            (
                "#import slot \"classify\"",
                "#import \"lib/step.wgsl\"\n#import slot \"classify\"",
            ),
            (
                "    let classified",
                "    if segment.length < 0.999 * step_world() {\n        return true;\n    }\n    let classified",
            ),
        ],
        "drops_last.wgsl",
    );
    let starts = planted(
        &scratch,
        post,
        &[(
            "reconstruct_scalar(segment_centre(ray, segment))",
            "segment.front.scalar",
        )],
        "starts.wgsl",
    );
    let lengthless = planted(
        &scratch,
        post,
        &[
            ("if segment.is_step {", "if false {"),
            (
                "stretch_of_one(scalar, segment.length)",
                "stretch_of_one(scalar, 0.1)",
            ),
        ],
        "lengthless.wgsl",
    );
    let technique = format!("technique={dropped}");
    for (args, order) in [
        // Held against the truth of what it means to be, and against itself.
        (
            vec!["--slot", &technique, "--as", "technique=dvr"],
            Some(1.0),
        ),
        (vec!["--slot", &technique], None),
        (vec!["--slot", &format!("classify={starts}")], Some(1.0)),
        (vec!["--slot", &format!("classify={lengthless}")], None),
    ] {
        let run = verify(&scratch, &args);
        assert_eq!(run.code, Some(1), "{args:?}: {run:?}");
        assert!(
            run.stderr.contains("error[order-below]"),
            "{args:?}: {run:?}"
        );
        assert_eq!(run.json()["passed"], false);
        if let Some(order) = order {
            let measured = quantity(&run, COLOR)["order"].as_f64().unwrap();
            assert!((measured - order).abs() < 0.2, "{args:?}: {measured}");
        }
    }
    // The declaration is what fails: the same shader that claims no more than it keeps passes.
    let run = verify(
        &scratch,
        &["--slot", &format!("classify={starts}"), "--expect", "1"],
    );
    assert_eq!(run.code, Some(0), "{run:?}");
    // And the right one fails where more is expected of it.
    let run = verify(&scratch, &["--slot", "classify=post", "--expect", "3"]);
    assert_eq!(run.code, Some(1), "{run:?}");
}

const GRAPH: &str = r#"(
    sources: { "v": analytic(field: "gyroid", dims: (8, 8, 8)), "t": transfer(path: "t.ron") },
    nodes: {
        "box": (kind: "proxy_box", in: { "volume": "v" }),
        "image": (kind: "raycast", in: { "volume": "v", "transfer": "t", "rays": "box" }),
    },
    outputs: { "color": "image.color" },
)
"#;

fn scene() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("graph.ron", GRAPH);
    scratch.write(
        "t.ron",
        "(color: (1, 0.5, 0.2), opacity: [(0, 0), (1, 0.5)])\n",
    );
    scratch
}

#[test]
fn what_limits_an_order_is_told_and_studies_are_drawn() {
    let scratch = scene();
    // So dense that rays would end early, and errors stand still at what is cut off.
    scratch.write(
        "t.ron",
        "(color: (1, 0.5, 0.2), opacity: [(0, 0), (1, 0.99)])\n",
    );
    let args = [
        "verify",
        "graph.ron",
        // Where rays end early, errors stand still at what is cut off: it is off, whatever is set.
        "--set",
        "image.early_termination=0.3",
        "--orders",
        "--svg",
        "plots",
        "--size",
        "24x24",
    ];
    let run = scratch.run(&args);
    assert_eq!(run.code, Some(0), "{run:?}");
    for told in [
        "orders above 2 need not show in this scene: the field has kinks",
        "the grid is not halved: the transfer function's opacity is stated for voxels",
        "`classify preintegrated_2d` declares 2: holds",
        "●",
    ] {
        assert!(run.stdout.contains(told), "{told}: {}", run.stdout);
    }
    let svg = fs::read_to_string(scratch.path().join("plots/step.svg")).unwrap();
    assert!(
        svg.starts_with("<svg") && svg.contains("colour: order"),
        "{svg}"
    );
    // Fewer halvings tell no order.
    assert_eq!(scratch.run(&["verify", "--halvings", "3"]).code, Some(2));
}

#[test]
fn pictures_are_rendered_again_and_changes_named() {
    let scratch = scene();
    let step = "image.step=0.7";
    for picture in ["a.png", "a.exr"] {
        let camera = "orbit(azimuth: 70, elevation: -10)";
        let args = ["render", "graph.ron", "-o", picture, "--size", "24x16"];
        let run = scratch.run(&[&args[..], &["--set", step, "--camera", camera]].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        let again = scratch.run(&["verify", picture, "--against", "reference", "--json"]);
        assert_eq!(again.code, Some(0), "{again:?}");
        let json = again.json();
        assert!(json["changed"] == Value::Array(Vec::new()), "{json}");
        assert_eq!(json["difference"], 0.0);
        // The truth of the same view: a step of 0.7 voxels and 8 bits are off by little, another view would not be.
        let rmse = json["reference"]["rmse"].as_f64().unwrap();
        assert!(rmse > 1e-6 && rmse < 5e-3, "{rmse}");
        let compared = scratch.run(&["compare", picture, "reference", "--json"]);
        let other = compared.json()["rmse"].as_f64().unwrap();
        assert!((other - rmse).abs() < 1e-7, "{other} {rmse}");
    }
    // A graph that was edited is told; the picture is rendered from its own text, so it is the same.
    scratch.write("graph.ron", GRAPH.replace("gyroid", "sphere"));
    let run = scratch.run(&["verify", "a.png"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.stdout.contains("graph has changed"), "{run:?}");
    // A source that was edited makes another picture.
    scratch.write(
        "t.ron",
        "(color: (1, 0.5, 0.2), opacity: [(0, 0), (1, 0.6)])\n",
    );
    for picture in ["a.png", "a.exr"] {
        let run = scratch.run(&["verify", picture]);
        assert_eq!(run.code, Some(1), "{run:?}");
        assert!(run.stdout.contains("source t has changed"), "{run:?}");
        assert!(run.stderr.contains("error[picture-differs]"), "{run:?}");
    }
    let run = scratch.run(&["verify", "a.png", "--set", "image.step=1"]);
    assert!(run.stderr.contains("error[own-settings]"), "{run:?}");
}
