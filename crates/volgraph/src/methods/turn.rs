//! The camera's way around what is drawn, by which frames are timed and small views are spread.

use glam::{DQuat, DVec3};
use volgraph_graph::{Camera, Plan};

/// A camera that has gone so many degrees around a target, about its own up direction.
#[must_use]
pub fn turned(camera: &Camera, target: DVec3, degrees: f64) -> Camera {
    let turn = DQuat::from_axis_angle(camera.up, degrees.to_radians());
    let mut turned = *camera;
    turned.eye = target + turn * (camera.eye - target);
    turned.right = turn * camera.right;
    turned.forward = turn * camera.forward;
    turned
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

    use super::turned;

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
}
