//! The node `shear_warp` in a graph: against the reference, with what is behind it, and what it refuses.

use volgraph_measure::compare_without_flip;
use volgraph_tests::truth::truth;
use volgraph_tests::{Stage, adapters, render};

const SIZE: [u32; 2] = [49, 41];

fn stage(camera: &str) -> Stage {
    let wave = |x: u32, y: u32, z: u32| {
        0.5 + 0.5 * (0.5 * x as f32 + 0.4 * (0.7 * y as f32).sin() - 0.4 * z as f32).sin()
    };
    Stage::new()
        .with_floats("v", [12, 9, 10], wave)
        .with(
            "transfer.ron",
            "(domain: data, points: [(at: 0, color: (0.1, 0.2, 0.9), opacity: 0), (at: 0.6, color: (0.9, 0.8, 0.1), opacity: 0.2), (at: 1, color: (1, 0.1, 0.1), opacity: 0.4)])",
        )
        .with(
            "graph.ron",
            format!(
                r#"(
    sources: {{ "volume": volume(path: "v_12x9x10_float32.raw"), "colors": transfer(path: "transfer.ron") }},
    camera: orbit(azimuth: 33, elevation: 21, {camera}),
    nodes: {{
        "background": (kind: "background", params: {{ "pattern": "gradient" }}),
        "image": (kind: "shear_warp", in: {{ "volume": "volume", "transfer": "colors", "behind": "background" }},
                  params: {{ "scale": 8.0, "slices_per_voxel": 8, "early_termination": 0.0 }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
            ),
        )
}

/// What is left is the outline of the box, soft over an eighth of a voxel.
#[test]
fn its_picture_is_that_of_the_reference() {
    let stage = stage("projection: orthographic");
    let (truth, _) = truth(&stage, &[], SIZE);
    let truth = truth.picture().unwrap();
    for backend in adapters() {
        for classify in ["preintegrated", "post"] {
            let set = format!("image.slab_classify={classify}");
            let (picture, _) = render(&stage, &[&set], &backend, SIZE);
            let error = compare_without_flip(&picture, &truth).unwrap().rmse;
            assert!(error < 2e-3, "{backend} {classify}: {error}");
        }
    }
}

#[test]
fn a_perspective_camera_is_refused_with_a_remedy() {
    let stage = stage("fov_y: 30");
    let backend = &adapters()[0];
    let findings = match stage.open("graph.ron", &[], backend, SIZE) {
        Ok(mut session) => session.render().map(|_| ()).unwrap_err(),
        Err(findings) => findings,
    };
    let text = findings.to_string();
    assert!(
        text.contains("perspective") && text.contains("orthographic") && text.contains("image"),
        "{text}"
    );
}

#[test]
fn an_intermediate_image_that_is_too_large_is_refused() {
    let stage =
        stage("projection: orthographic").with_floats("v", [9000, 2, 2], |x, _, _| x as f32);
    let text = std::fs::read_to_string(stage.path().join("graph.ron")).unwrap();
    let stage = stage.with("graph.ron", text.replace("v_12x9x10", "v_9000x2x2"));
    let findings = stage.open("graph.ron", &[], &adapters()[0], SIZE);
    let text = findings.map(|_| ()).unwrap_err().to_string();
    assert!(
        text.contains("too-many-pixels") && text.contains("scale"),
        "{text}"
    );
}
