//! The reference and the difference of two pictures as nodes: they show what a comparison outside of the graph finds.

use volgraph::TruthOptions;
use volgraph_tests::layers::{scalars, vectors};
use volgraph_tests::truth::truth_of;
use volgraph_tests::{Stage, adapters, render};

const GRAPH: &str = r#"(
    sources: {
        "volume": analytic(field: "marschner_lobb", dims: (16, 16, 16)),
        "colors": transfer(path: "transfer.ron"),
    },
    camera: orbit(azimuth: 30, elevation: 20),
    nodes: {
        "background": (kind: "background", params: { "pattern": "checker" }),
        "box":   (kind: "proxy_box", in: { "volume": "volume" }),
        "image": (kind: "raycast",
                  in: { "volume": "volume", "transfer": "colors", "rays": "box", "behind": "background" },
                  params: { "step": 2.0 }),
        "truth": (kind: "reference", in: { "of": "image.color" }),
        "off":   (kind: "difference", in: { "a": "image.color", "b": "truth.color" },
                  params: { "amplification": 8.0 }),
    },
    outputs: { "color": "off.color", "off": "off.error", "drawn": "image.color", "truth": "truth.color" },
)"#;

const TRANSFER: &str = "(domain: normalised, color: [(0, (1, 0.2, 0)), (1, (0, 0.5, 1))], opacity: [(0, 0), (1, 0.3)])";

#[test]
fn nodes_show_the_error_that_a_comparison_finds() {
    let stage = Stage::new()
        .with("graph.ron", GRAPH)
        .with("transfer.ron", TRANSFER);
    for backend in adapters() {
        let (picture, _) = render(&stage, &[], &backend, [24, 24]);
        // The truth of the raycast itself.
        stage.write(
            "plain.ron",
            GRAPH.replace("\"off.color\"", "\"image.color\""),
        );
        let plain = stage.path().join("plain.ron");
        let (truth, _) =
            truth_of(&plain, &[], [24, 24], TruthOptions::default().tolerance).unwrap();
        let truth = truth.picture().unwrap();

        let (drawn, shown) = (vectors(&picture, "drawn"), scalars(&picture, "off"));
        assert_eq!(vectors(&picture, "truth"), truth.color, "{backend}");
        let mut largest: f32 = 0.0;
        for at in 0..drawn.len() {
            let off: [f32; 4] = std::array::from_fn(|i| drawn[at][i] - truth.color[at][i]);
            let error = off.iter().fold(0.0_f32, |most, off| most.max(off.abs()));
            largest = largest.max(error);
            assert_eq!(shown[at], error, "{backend}, pixel {at}");
            for (shown, off) in picture.color[at].iter().zip(&off[..3]) {
                let color = 8.0 * off.abs();
                assert!((shown - color).abs() < 1e-6, "{backend}, pixel {at}");
            }
        }
        // There is something to see.
        assert!((1e-4..0.1).contains(&largest), "{backend}: {largest}");
    }
}
