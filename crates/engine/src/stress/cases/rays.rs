//! Rays in special places: cameras on, in and far from the box, along its faces and axes, narrow and wide fields of view.

use super::{BLOB, INTEGRATED, SIZE, SOFT_WHY, blob_scene, soft_bound};
use crate::stress::case::{Bound, Case, Method, Point, Quantity, Truth};
use crate::stress::scene_text::{SceneText, VolumeText};

pub(super) fn cases() -> Vec<Case> {
    vec![cameras(), directions(), far_away(), fields_of_view()]
}

/// Half a voxel's step, and early termination.
pub(super) const HALF_STEP: Bound = Bound {
    of: |_| soft_bound(0.5) + 2.5e-4 + 2e-4,
    why: SOFT_WHY,
};

/// Both forms of the walk, which find their rays in different ways.
pub(super) fn both_stages(bound: Bound) -> Vec<Method> {
    ["fragment", "compute"]
        .map(|stage| {
            let mut sets = INTEGRATED.to_vec();
            sets.extend([("stage", stage), ("step", "0.5")]);
            Method::holds(stage, &sets, bound)
        })
        .into()
}

/// Matter everywhere, so that each length of a ray in the box shows.
const FOG: &str = "(domain: range, color: [(0.0, (0.2, 0.4, 0.9)), (1.0, (1.0, 0.7, 0.2))], \
                   extinction: [(0.0, 0.02), (1.0, 0.5)])";

fn fog_scene(name: &str, camera: &str) -> SceneText {
    SceneText::new(
        name,
        VolumeText::floats("blob", BLOB, super::blob(1.0)),
        FOG,
        camera,
    )
}

fn cameras() -> Case {
    // The box is -0.5 to 23.5; the floats beside -0.5 are 6e-8 away, those beside 23.5 two millionths.
    let places = [
        ("outside", "(-20.0, -13.0, 25.0)"),
        ("on a face", "(-0.5, 9.3, 8.1)"),
        ("a float before a face", "(-0.50000006, 9.3, 8.1)"),
        ("a float inside of a face", "(-0.49999997, 9.3, 8.1)"),
        ("a float inside of the far face", "(23.499998, 9.3, 8.1)"),
        ("on an edge", "(-0.5, -0.5, 8.1)"),
        ("on a corner", "(-0.5, -0.5, -0.5)"),
        ("inside", "(6.1, 7.2, 9.3)"),
        ("in the middle", "(11.5, 11.5, 11.5)"),
    ];
    let point = |(at, (label, eye)): (usize, (&str, &str))| {
        let target = if label == "in the middle" {
            "(16.0, 13.0, 12.5)"
        } else {
            "(11.7, 11.2, 12.3)"
        };
        let camera = format!("look_at(eye: {eye}, target: {target}, fov_y: 60)");
        Point::named(
            at as f64,
            label,
            fog_scene(&format!("camera_{at}"), &camera),
        )
    };
    Case {
        name: "camera-at-the-box",
        breaks: "An eye on a face or inside has no entry in front of it: proxy geometry is cut at the near plane, and \
                 distances of 0 are divided by.",
        swept: "place of the eye",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: places.into_iter().enumerate().map(point).collect(),
        methods: both_stages(HALF_STEP),
    }
}

fn directions() -> Case {
    // Pixels are a voxel apart; their rays run through voxel centres, along the planes between voxels or along the faces.
    let square = "projection: orthographic, height: 40.0";
    let places = [
        (
            "along x, voxel centres",
            "(-30, 12, 12)",
            "(0, 12, 12)",
            "(0, 0, 1)",
        ),
        (
            "along -x, voxel faces",
            "(60, 11.5, 11.5)",
            "(0, 11.5, 11.5)",
            "(0, 0, 1)",
        ),
        ("along y", "(12, -30, 12)", "(12, 0, 12)", "(0, 0, 1)"),
        ("along -z", "(12, 12, 60)", "(12, 12, 0)", "(0, 1, 0)"),
        (
            "along the box's faces",
            "(-30, 11, 11)",
            "(0, 11, 11)",
            "(0, 0, 1)",
        ),
        (
            "across an edge",
            "(-30, -30, 11.5)",
            "(11.5, 11.5, 11.5)",
            "(0, 0, 1)",
        ),
        (
            "along the diagonal",
            "(-30, -30, -30)",
            "(11.5, 11.5, 11.5)",
            "(0, 0, 1)",
        ),
        (
            "almost along x",
            "(-30, 12, 12)",
            "(11, 12.000001, 12)",
            "(0, 0, 1)",
        ),
    ];
    let point = |(at, (label, eye, target, up)): (usize, (&str, &str, &str, &str))| {
        let camera = format!("look_at(eye: {eye}, target: {target}, up: {up}, {square})");
        Point::named(
            at as f64,
            label,
            blob_scene(&format!("direction_{at}"), &camera),
        )
    };
    Case {
        name: "axis-parallel-rays",
        breaks: "A ray along an axis divides by 0 where it is clipped to the box, and one along a face has no crossing \
                 with it; along edges and diagonals it meets two or three faces at once.",
        swept: "direction",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: places.into_iter().enumerate().map(point).collect(),
        methods: both_stages(HALF_STEP),
    }
}

fn far_away() -> Case {
    let point = |boxes: f64| {
        let distance = 24.0 * boxes;
        let fov = 2.0 * (18.0_f64 / distance).atan().to_degrees();
        let camera =
            format!("orbit(azimuth: 33, elevation: 21, distance: {distance:?}, fov_y: {fov:?})");
        Point::new(boxes, blob_scene(&format!("far_{boxes}"), &camera))
    };
    Case {
        name: "camera-far-away",
        breaks: "From an eye a million boxes away a float has no digits left for the box: its entry is off by voxels.",
        swept: "distance of the eye (sides of the box)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: [1e1, 1e2, 1e3, 1e4, 1e5, 1e6].map(point).into(),
        methods: both_stages(HALF_STEP),
    }
}

fn fields_of_view() -> Case {
    let point = |fov: f64| {
        // As near as the blob fills the view, and not nearer than its box.
        let distance = (10.0 / (0.5 * fov).to_radians().tan()).max(14.0);
        let camera =
            format!("orbit(azimuth: 33, elevation: 21, distance: {distance:?}, fov_y: {fov:?})");
        Point::new(fov, blob_scene(&format!("fov_{fov}"), &camera))
    };
    Case {
        name: "field-of-view",
        breaks: "A view of a tenth of a degree has rays that differ in their last digits; one of 170° has rays almost \
                 across the view.",
        swept: "vertical field of view (degrees)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: [0.1, 1.0, 30.0, 120.0, 170.0].map(point).into(),
        methods: both_stages(HALF_STEP),
    }
}
