//! What did not change is not done again: counts of the nodes that run.

use volgraph::{Change, Outcome};
use volgraph_graph::CameraDesc;
use volgraph_graph::camera::Pose;
use volgraph_tests::{Stage, adapters, graph};

fn stage() -> Stage {
    Stage::new()
        .with_floats("v", [8, 8, 8], |x, y, z| (x * y + z) as f32)
        .with("transfer.ron", "(points: [(at: 0, color: (0, 0, 1), opacity: 0), (at: 1, color: (1, 0, 0), opacity: 0.5)])")
        .with(
            "graph.ron",
            graph(
                r#"path: "v_8x8x8_float32.raw""#,
                "orbit(azimuth: 10, elevation: 10)",
                r#"{ "pattern": "checker" }"#,
                r#"{ "light": "phong", "classify": "preintegrated_2d" }"#,
                "{}",
            ),
        )
}

fn orbit(azimuth: f64) -> CameraDesc {
    let pose = Pose::Orbit {
        azimuth,
        elevation: 10.0,
        roll: 0.0,
        distance: None,
        target: None,
        zoom: 1.0,
    };
    CameraDesc {
        pose,
        ..CameraDesc::default()
    }
}

#[test]
fn a_moving_camera_runs_the_raycast_alone() {
    let stage = stage();
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, [32, 32]).unwrap();
        let first = session.draw().unwrap();
        assert_eq!(
            first.ran(),
            [
                "background",
                "box",
                "image.volume_texture",
                "image.gradient",
                "image.preintegration",
                "image"
            ]
        );
        assert!(session.draw().unwrap().ran().is_empty(), "nothing changed");
        let before = session.render().unwrap().0;
        for azimuth in [20.0, 30.0] {
            session.set_camera(&orbit(azimuth));
            assert_eq!(session.draw().unwrap().ran(), ["image"], "{backend}");
        }
        let moved = session.render().unwrap().0;
        assert!(moved.color != before.color, "the camera did move");
        session.set_camera(&orbit(10.0));
        let again = session.render().unwrap().0;
        assert!(
            again.color == before.color,
            "the same view is the same picture"
        );
    }
}

#[test]
fn another_size_keeps_what_does_not_depend_on_it() {
    let stage = stage();
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, [32, 32]).unwrap();
        session.draw().unwrap();
        let drawn = match session.apply(&Change::Size([40, 24])).unwrap() {
            Outcome::Drawn(drawn) => drawn,
            Outcome::Unchanged => panic!("{backend}: another size is another picture"),
        };
        assert_eq!((drawn.picture.width, drawn.picture.height), (40, 24));
        let frame = drawn.report.frame;
        assert_eq!(frame.ran(), ["background", "image"], "{backend}");
        assert_eq!(frame.memory.reused, 4, "box, volume, gradients and table");
        assert!(session.draw().unwrap().ran().is_empty());
    }
}

#[test]
fn a_refused_size_leaves_the_session_as_it_was() {
    let stage = stage();
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, [32, 32]).unwrap();
        let before = session.render().unwrap().0;
        let refused = session.apply(&Change::Size([1_000_000, 10])).unwrap_err();
        assert!(
            refused
                .findings
                .into_iter()
                .all(|finding| finding.code == "over-limit")
        );
        assert!(session.draw().unwrap().ran().is_empty(), "{backend}");
        let after = session.render().unwrap().0;
        assert!(after.color == before.color);
    }
}
