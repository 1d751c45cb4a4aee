//! Where cameras stand, and what of a box they see.

use super::*;

fn cube() -> Vec<DVec3> {
    (0..8)
        .map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0)
        .collect()
}

#[test]
fn the_default_orbit_faces_a_patient() {
    let pose = Pose::Orbit {
        azimuth: 0.0,
        elevation: 0.0,
        roll: 0.0,
        distance: None,
        target: None,
        zoom: 1.0,
    };
    let camera = CameraDesc {
        pose,
        ..CameraDesc::default()
    }
    .fit(&cube(), 1.0);
    assert!(camera.forward.distance(DVec3::Y) < 1e-12);
    // The patient's left (+x) is at the right of the picture.
    assert!(camera.right.distance(DVec3::X) < 1e-12);
    assert!(camera.up.distance(DVec3::Z) < 1e-12);
}

#[test]
fn a_zoom_divides_what_is_fitted() {
    let corners = [DVec3::ZERO, DVec3::new(4.0, 2.0, 1.0)];
    let camera = |projection, zoom| {
        let pose = Pose::Orbit {
            azimuth: 20.0,
            elevation: 10.0,
            roll: 0.0,
            distance: None,
            target: None,
            zoom,
        };
        let camera = CameraDesc {
            pose,
            projection,
            ..CameraDesc::default()
        };
        camera.fit(&corners, 1.5)
    };
    let middle = DVec3::new(2.0, 1.0, 0.5);
    let perspective = Projection::Perspective { fov_y: 30.0 };
    let distance = |zoom| camera(perspective, zoom).eye.distance(middle);
    assert!((distance(1.0) / distance(2.5) - 2.5).abs() < 1e-12);
    let height = |zoom| match camera(Projection::Orthographic { height: None }, zoom).projection {
        Projection::Orthographic { height } => height.unwrap(),
        other => panic!("{other:?}"),
    };
    assert!((height(1.0) / height(2.5) - 2.5).abs() < 1e-12);
}

#[test]
fn a_fitted_view_holds_the_whole_box() {
    for elevation in [-90.0, -30.0, 0.0, 45.0, 90.0] {
        for projection in [
            Projection::Perspective { fov_y: 40.0 },
            Projection::Orthographic { height: None },
        ] {
            for size in [[400, 200], [200, 400], [300, 300]] {
                let pose = Pose::Orbit {
                    azimuth: 77.0,
                    elevation,
                    roll: 10.0,
                    distance: None,
                    target: None,
                    zoom: 1.0,
                };
                let aspect = f64::from(size[0]) / f64::from(size[1]);
                let camera = CameraDesc {
                    pose,
                    projection,
                    up: DVec3::Y,
                }
                .fit(&cube(), aspect);
                let view = View {
                    camera,
                    size,
                    window: None,
                };
                let [x, y, w, h] = view.pixel_bounds(&cube()).unwrap();
                assert!(
                    x > 0 && y > 0 && x + w < size[0] && y + h < size[1],
                    "{elevation} {size:?}"
                );
                assert!(w.max(h) * 2 > size[0].min(size[1]), "too small in the view");
            }
        }
    }
}

#[test]
fn from_inside_the_box_may_be_anywhere_and_behind_is_nowhere() {
    let pose = Pose::LookAt {
        eye: DVec3::ONE,
        target: Some(DVec3::new(1.0, 5.0, 1.0)),
    };
    let camera = CameraDesc {
        pose,
        ..CameraDesc::default()
    }
    .fit(&cube(), 1.0);
    let view = View {
        camera,
        size: [64, 64],
        window: None,
    };
    assert_eq!(view.pixel_bounds(&cube()), Some([0, 0, 64, 64]));
    let aside: Vec<DVec3> = cube()
        .iter()
        .map(|c| *c + DVec3::new(1000.0, 20.0, 0.0))
        .collect();
    assert_eq!(view.pixel_bounds(&aside), None);
}
