//! The camera's way around what is drawn, by which frames are timed and small views are spread.

use glam::{DQuat, DVec3};
use volgraph_graph::{Camera, Plan};

/// Less than this many degrees from frame to frame may be no other view for a device's floats.
pub const LEAST_TURN_DEGREES: f64 = 1e-3;

/// A camera that has gone so many degrees around a target, about its own up direction.
#[must_use]
pub fn turned(camera: &Camera, target: DVec3, degrees: f64) -> Camera {
    Camera {
        up: camera.up,
        ..around(camera, target, camera.up, degrees)
    }
}

/// A camera that has gone so many degrees around a target, about a direction of the world.
#[must_use]
pub fn around(camera: &Camera, target: DVec3, axis: DVec3, degrees: f64) -> Camera {
    let turn = DQuat::from_axis_angle(axis.normalize_or(DVec3::Z), degrees.to_radians());
    Camera {
        eye: target + turn * (camera.eye - target),
        right: turn * camera.right,
        up: turn * camera.up,
        forward: turn * camera.forward,
        projection: camera.projection,
    }
}

/// The middle of the boxes that a plan's camera fits, in world space: the mean of their corners, and the origin where there
/// are none. The camera turns around it.
#[must_use]
pub fn middle(plan: &Plan) -> DVec3 {
    let corners = plan.corners();
    corners.iter().sum::<DVec3>() / corners.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use volgraph_graph::{Camera, Projection};

    use super::{around, turned};

    #[test]
    fn a_turned_camera_keeps_its_distance_and_looks_at_the_target() {
        let target = DVec3::new(1.0, 2.0, 3.0);
        let camera = Camera {
            eye: target + DVec3::new(0.0, 0.0, 5.0),
            right: DVec3::X,
            up: DVec3::Y,
            forward: -DVec3::Z,
            projection: Projection::Orthographic { height: None },
        };
        let quarter = turned(&camera, target, 90.0);
        assert!((quarter.eye - (target + 5.0 * DVec3::X)).length() < 1e-12);
        assert!((quarter.forward + DVec3::X).length() < 1e-12);
        assert!((quarter.right + DVec3::Z).length() < 1e-12);
        assert_eq!(quarter.up, camera.up);
    }

    #[test]
    fn the_camera_goes_around_the_vertical_axis_at_its_height() {
        let camera = Camera {
            eye: DVec3::new(0.0, -4.0, 3.0),
            right: DVec3::X,
            up: DVec3::new(0.0, 0.6, 0.8),
            forward: DVec3::new(0.0, 0.8, -0.6),
            projection: Projection::Orthographic { height: None },
        };
        let half = around(&camera, DVec3::ZERO, 2.0 * DVec3::Z, 180.0);
        assert!((half.eye - DVec3::new(0.0, 4.0, 3.0)).length() < 1e-12);
        assert!((half.forward - DVec3::new(0.0, -0.8, -0.6)).length() < 1e-12);
        assert!((half.up - DVec3::new(0.0, -0.6, 0.8)).length() < 1e-12);
    }
}
