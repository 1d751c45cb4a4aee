//! Left is left: one object, stored in all eight orientations of its axes by the libraries that people use, is drawn where
//! it is in the world (`tests/orientations/make.py`).

use glam::DVec3;
use volgraph_tests::{Stage, adapters, box_interval, ray, render, root};

/// First voxel's centre, distances between voxels, and how many there are.
const ORIGIN: DVec3 = DVec3::new(10.0, 20.0, 30.0);
const SPACING: DVec3 = DVec3::new(2.0, 3.0, 4.0);
const DIMS: DVec3 = DVec3::new(6.0, 5.0, 4.0);

/// The voxels of the marker: an arm to the left, one to the back, one up.
fn marker() -> Vec<DVec3> {
    let left = (1..6).map(|x| DVec3::new(f64::from(x), 1.0, 1.0));
    let back = (2..4).map(|y| DVec3::new(1.0, f64::from(y), 1.0));
    left.chain(back)
        .chain([DVec3::new(1.0, 1.0, 2.0)])
        .collect()
}

/// Whether a ray meets the marker, its voxels grown by a share; where `node_centred` they end at the last centres.
fn meets(ray: (DVec3, DVec3), share: f64, node_centred: bool) -> bool {
    let (first, last) = (ORIGIN, ORIGIN + SPACING * (DIMS - 1.0));
    marker().into_iter().any(|voxel| {
        let centre = ORIGIN + SPACING * voxel;
        let half = 0.5 * SPACING * share;
        let (mut low, mut high) = (centre - half, centre + half);
        if node_centred {
            (low, high) = (low.max(first), high.min(last));
        }
        box_interval(ray, low, high).is_some()
    })
}

const CAMERAS: [&str; 3] = [
    // From the front: the patient's left is on the right, up is up.
    "look_at(eye: (15.0, -100.0, 36.0), target: (15.0, 26.0, 36.0), projection: orthographic, height: 20.0)",
    // From the patient's left: the front is on the left.
    "look_at(eye: (150.0, 26.0, 36.0), target: (15.0, 26.0, 36.0), projection: orthographic, height: 20.0)",
    "look_at(eye: (60.0, -70.0, 120.0), target: (15.0, 26.0, 36.0), fov_y: 15)",
];

#[test]
fn left_is_left_in_all_eight_orientations_of_all_formats() {
    let mut wrong = Vec::new();
    let mut drawn = 0;
    for ending in [".nii.gz", ".nrrd", ".mha", ".vti", "_dicom"] {
        for signs in ["+++", "++-", "+-+", "+--", "-++", "-+-", "--+", "---"] {
            let file = root().join(format!("tests/orientations/m{signs}{ending}"));
            for (number, camera) in CAMERAS.iter().enumerate() {
                let stage = Stage::new()
                    .with("t.ron", "(domain: data, color: (1, 1, 1), extinction: [(0.0, 0.0), (100.0, 0.0), (100.0, 90.0), (255.0, 90.0)])")
                    .with(
                        "graph.ron",
                        format!(
                            r#"(
    sources: {{ "v": volume(path: {:?}), "t": transfer(path: "t.ron") }},
    camera: {camera},
    nodes: {{
        "box": (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "box" }},
                  slots: {{ "reconstruct": "nearest", "classify": "post" }}, params: {{ "step": 0.02 }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#,
                            file.display().to_string()
                        ),
                    );
                let (picture, view) = render(&stage, &[], &adapters()[0], [64, 48]);
                let node_centred = ending == ".vti";
                let (mut inside, mut outside, mut missed) = (0, 0, 0);
                for y in 0..picture.height {
                    for x in 0..picture.width {
                        let ray = ray(&view, x, y);
                        let opacity = picture.color[(y * picture.width + x) as usize][3];
                        let sure = meets(ray, 0.9, node_centred);
                        if sure {
                            inside += 1;
                            missed += u32::from(opacity < 0.9);
                        } else if !meets(ray, 1.1, node_centred) {
                            outside += 1;
                            missed += u32::from(opacity > 0.1);
                        }
                    }
                }
                drawn += 1;
                assert!(inside > 50 && outside > 200, "{inside} {outside} {camera}");
                if missed > 0 {
                    wrong.push(format!(
                        "m{signs}{ending}, camera {number}: {missed} pixels"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(drawn, 5 * 8 * 3);
}
