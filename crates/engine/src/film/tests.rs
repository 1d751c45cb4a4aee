//! Ways pass through their keys, and go as they say between them.

use std::path::Path;

use glam::DVec3;
use volgraph_graph::{Camera, Plan};

use super::{CameraPath, Film};
use crate::truth::plan_without_device;
use crate::{NoProgress, Overrides, Scene, ShaderFolders, registry};

fn plan() -> Plan {
    let graph = Path::new("quickstart");
    let overrides = Overrides::default();
    let folders = ShaderFolders::default();
    let scene = Scene::load(graph, &overrides, &folders, registry(), &NoProgress).unwrap();
    plan_without_device(&scene, [64, 48]).unwrap()
}

fn film(plan: &Plan, keys: &str, frames: u32) -> Vec<Camera> {
    let text = format!("(path: 1, frames: 9, keys: [{keys}])");
    let path = CameraPath::of_text(Path::new("path.ron"), &text).unwrap();
    assert_eq!(path.frames(), Some(9));
    let frames = Film::new(&path, plan, frames);
    frames.frames().iter().map(|it| it.camera).collect()
}

fn camera(plan: &Plan, text: &str) -> Camera {
    plan.fit(&volgraph_graph::read::camera_text(Path::new("c"), text).unwrap())
}

#[test]
fn keys_are_met_exactly_and_ends_are_held() {
    let plan = plan();
    let ways = [
        [
            "orbit(azimuth: 10)",
            "orbit(azimuth: 80, elevation: 50, zoom: 2)",
            "orbit(azimuth: -40, roll: 9)",
        ],
        [
            "orbit(azimuth: 10)",
            "look_at(eye: (3, 4, 5))",
            "look_at(eye: (-1, -9, 0), target: (1, 0, 0))",
        ],
        [
            "orbit(azimuth: 10, projection: orthographic)",
            "orbit(azimuth: 80, projection: orthographic, zoom: 3)",
            "look_at(eye: (3, 4, 5), height: 7)",
        ],
    ];
    for way in ways {
        let [a, b, c] = way;
        let keys = format!("(at: 1, camera: {a}), (at: 4, camera: {b}), (at: 7, camera: {c})");
        let cameras = film(&plan, &keys, 9);
        for (frame, key) in [(0, a), (1, a), (4, b), (7, c), (8, c)] {
            assert_eq!(cameras[frame], camera(&plan, key), "{way:?} {frame}");
        }
        // The same path in more frames, of which every second is one of the path's own.
        let more = film(&plan, &keys, 17);
        for (frame, camera) in cameras.iter().enumerate() {
            assert!(more[2 * frame].eye.distance(camera.eye) < 1e-9);
        }
        for camera in more {
            let axes = [camera.right, camera.up, camera.forward];
            assert!(axes.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-9));
            assert!(camera.right.cross(camera.forward).distance(camera.up) < 1e-9);
        }
    }
}

#[test]
fn orbits_keep_their_distance_and_go_all_the_way_around() {
    let plan = plan();
    let keys = "(at: 0, camera: orbit(azimuth: 0)), (at: 8, camera: orbit(azimuth: 720))";
    let cameras = film(&plan, keys, 9);
    for (frame, is) in cameras.iter().enumerate() {
        let wanted = camera(&plan, &format!("orbit(azimuth: {})", 90 * frame));
        assert!(is.eye.distance(wanted.eye) < 1e-9, "{frame}");
        assert!(is.up.distance(wanted.up) < 1e-9, "{frame}");
    }
    // Twice as near in two steps: the square root of that in one.
    let keys = "(at: 0, camera: orbit(distance: 8, target: (0, 0, 0))),
                (at: 8, camera: orbit(distance: 2, target: (0, 0, 0)))";
    let cameras = film(&plan, keys, 9);
    assert!((cameras[4].eye.length() - 4.0).abs() < 1e-9);
}

#[test]
fn a_turntable_goes_as_the_azimuth_does() {
    let plan = plan();
    let path = CameraPath::Turntable { degrees: 360.0 };
    let film = Film::new(&path, &plan, 5);
    let first = film.frames()[0].camera;
    assert_eq!(first, plan.view().camera);
    let text = "orbit(azimuth: 72, elevation: 20)";
    let start = camera(&plan, &text.replace("72", "0"));
    let turned = super::turned_cameras(&start, super::target(&plan), DVec3::Z, 360.0, 5);
    assert!(turned[1].eye.distance(camera(&plan, text).eye) < 1e-9);
    assert!(turned[1].up.distance(camera(&plan, text).up) < 1e-9);
    // Five steps close; the doubled frame is left out.
    assert_eq!(turned.len(), 5);
    assert!(turned[4].eye.distance(start.eye) > 0.1);
    let arc = super::turned_cameras(&start, super::target(&plan), DVec3::Z, 72.0, 3);
    assert!(arc[2].eye.distance(camera(&plan, text).eye) < 1e-9);
    assert_eq!(
        super::turned_cameras(&start, DVec3::ZERO, DVec3::Z, 90.0, 1),
        [start]
    );
}

#[test]
fn values_go_on_lines_and_texts_hold() {
    let plan = plan();
    let text = r#"(path: 1, keys: [
        (at: 0, set: { "image.step": 1, "image.light_1": [0, 0, 2, 0] }),
        (at: 2, set: { "image.slots.light": "phong" }),
        (at: 4, set: { "image.step": 0.5, "image.light_1": [4, 0, 0, 0], "image.slots.light": "unlit" }),
    ])"#;
    let path = CameraPath::of_text(Path::new("path.ron"), text).unwrap();
    let film = Film::new(&path, &plan, 5);
    let typed = |frame: usize| -> Vec<&str> {
        let sets = film.frames()[frame].sets.iter();
        sets.map(|set| set.typed.as_str()).collect()
    };
    assert_eq!(
        typed(0),
        [
            "image.step=1",
            "image.light_1=[0.0, 0.0, 2.0, 0.0]",
            "image.slots.light=\"phong\""
        ]
    );
    assert_eq!(
        typed(1),
        [
            "image.step=0.875",
            "image.light_1=[1.0, 0.0, 1.5, 0.0]",
            "image.slots.light=\"phong\""
        ]
    );
    assert_eq!(typed(3)[2], "image.slots.light=\"phong\"");
    assert_eq!(
        typed(4),
        [
            "image.step=0.5",
            "image.light_1=[4.0, 0.0, 0.0, 0.0]",
            "image.slots.light=\"unlit\""
        ]
    );
    // No key has a camera: it is the graph's.
    assert!(
        film.frames()
            .iter()
            .all(|it| it.camera == plan.view().camera)
    );
}
