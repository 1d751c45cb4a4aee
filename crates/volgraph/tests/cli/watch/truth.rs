//! `volgraph watch --against reference`: how far each picture is from its truth.

use serde_json::Value;

use super::Watch;
use crate::Scratch;

const GRAPH: &str = r#"(
    sources: { "v": analytic(field: "gyroid", dims: (8, 8, 8)), "t": transfer(path: "t.ron") },
    nodes: {
        "box": (kind: "proxy_box", in: { "volume": "v" }),
        "image": (kind: "raycast", in: { "volume": "v", "transfer": "t", "rays": "box" }, params: { "step": STEP }),
    },
    outputs: { "color": "image.color" },
)
"#;

fn rmse(event: &Value) -> f64 {
    let rmse = event["difference"]["rmse"].as_f64();
    rmse.unwrap_or_else(|| panic!("{event}"))
}

#[test]
fn pictures_come_nearer_to_their_truth_as_the_step_is_halved() {
    let scratch = Scratch::new();
    let save = |step: &str| scratch.write("graph.ron", GRAPH.replace("STEP", step));
    scratch.write(
        "t.ron",
        "(color: (1, 0.5, 0.2), opacity: [(0, 0), (1, 0.5)])\n",
    );
    save("1.0");
    let watch = Watch::start(scratch.path(), &["--against", "reference"]);
    let coarse = rmse(&watch.next("picture"));
    watch.next("watching");
    save("0.25");
    let fine = rmse(&watch.next("picture"));
    // Order 2, from a hundredth of white or so.
    assert!(coarse > 1e-4 && coarse < 0.05, "{coarse}");
    assert!((4.0..40.0).contains(&(coarse / fine)), "{coarse} {fine}");
    // Another scene has another truth, and what has none is told and compared with nothing.
    scratch.write(
        "t.ron",
        "(color: (1, 0.5, 0.2), opacity: [(0, 0), (1, 0.9)])\n",
    );
    let other = rmse(&watch.next("picture"));
    assert!(other < 0.05 && other != fine, "{other} {fine}");
    let refraction = GRAPH.replace("STEP", "1.0").replace(
        "params:",
        r#"slots: { "technique": "translucency" }, params:"#,
    );
    scratch.write("graph.ron", refraction);
    assert_eq!(watch.next("picture")["difference"], Value::Null);
}
