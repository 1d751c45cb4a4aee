//! The camera under the mouse: orbiting, panning, zooming, rolling, axis views, walking.
//!
//! Drags count in shares of the view's height, so they feel the same in windows of any size: a drag over the whole
//! height turns by 180°, and moves what lies at the pivot's depth by exactly the drag.

use glam::{DQuat, DVec3};
use volgraph_engine::{Camera, CameraDesc};
use volgraph_graph::{Pose, Projection};

/// Degrees of a turn for a drag over the height of the view.
const TURN: f64 = 180.0;

/// Closer to the pivot than this share of the radius the eye does not come by zooming.
const NEAREST: f64 = 1e-3;

/// The field of view where a parallel projection becomes a perspective one.
const FOV_Y: f64 = 30.0;

/// A direction to look along: from its side, at the pivot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// From +x.
    Left,
    /// From -x.
    Right,
    /// From -y.
    Front,
    /// From +y.
    Back,
    /// From +z.
    Top,
    /// From -z.
    Bottom,
}

impl Axis {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::Front, "Front"),
        (Self::Back, "Back"),
        (Self::Left, "Left"),
        (Self::Right, "Right"),
        (Self::Top, "Top"),
        (Self::Bottom, "Bottom"),
    ];

    /// From where to look, and what is up.
    fn frame(self) -> (DVec3, DVec3) {
        match self {
            Self::Left => (DVec3::X, DVec3::Z),
            Self::Right => (DVec3::NEG_X, DVec3::Z),
            Self::Front => (DVec3::NEG_Y, DVec3::Z),
            Self::Back => (DVec3::Y, DVec3::Z),
            Self::Top => (DVec3::Z, DVec3::NEG_Y),
            Self::Bottom => (DVec3::NEG_Z, DVec3::Y),
        }
    }
}

/// A camera, the point that it turns around, and how large the scene is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Navigation {
    /// The camera.
    pub camera: Camera,
    /// World position that it turns around.
    pub pivot: DVec3,
    /// World position of the middle of all volumes.
    pub middle: DVec3,
    /// Of a sphere around all volumes, world units.
    pub radius: f64,
}

impl Navigation {
    /// Around the middle of `corners`, in world space.
    #[must_use]
    pub fn new(camera: Camera, corners: &[DVec3]) -> Self {
        let (low, high) = corners.iter().fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), corner| (low.min(*corner), high.max(*corner)),
        );
        let is_empty = corners.is_empty() || !(high - low).is_finite();
        let (pivot, radius) = match is_empty {
            true => (DVec3::ZERO, 1.0),
            false => (0.5 * (low + high), (0.5 * (high - low)).length()),
        };
        Self {
            camera,
            pivot,
            middle: pivot,
            radius: radius.max(f64::MIN_POSITIVE),
        }
    }

    /// Distance of the eye from the pivot along the view.
    fn distance(&self) -> f64 {
        (self.pivot - self.camera.eye).dot(self.camera.forward)
    }

    /// World units of the view's height at the pivot.
    #[must_use]
    pub fn height_at_pivot(&self) -> f64 {
        match self.camera.projection {
            Projection::Orthographic { height } => height.unwrap_or(2.0 * self.radius),
            Projection::Perspective { fov_y } => {
                let distance = self.distance().max(NEAREST * self.radius);
                2.0 * distance * (0.5 * fov_y.to_radians()).tan()
            }
        }
    }

    fn turn(&mut self, turn: DQuat) {
        let camera = &mut self.camera;
        camera.eye = self.pivot + turn * (camera.eye - self.pivot);
        camera.forward = (turn * camera.forward).normalize();
        let right = turn * camera.right;
        camera.right = (right - camera.forward * right.dot(camera.forward)).normalize();
        camera.up = camera.right.cross(camera.forward);
    }

    /// Turns the scene under the mouse around the pivot: to the right and upwards, in heights of the view.
    pub fn orbit(&mut self, right: f64, down: f64) {
        // Around the world's vertical axis where the camera stands upright, so that patients do not topple.
        let vertical = match self.camera.up.z.abs() > 0.2 {
            true => DVec3::Z * self.camera.up.z.signum(),
            false => self.camera.up,
        };
        let level = DQuat::from_axis_angle(vertical, (-right * TURN).to_radians());
        let tilt = DQuat::from_axis_angle(self.camera.right, (-down * TURN).to_radians());
        self.turn(level * tilt);
    }

    /// Turns the picture around its middle, by radians.
    pub fn roll(&mut self, angle: f64) {
        let turn = DQuat::from_axis_angle(self.camera.forward, angle);
        let camera = &mut self.camera;
        camera.right = (turn * camera.right).normalize();
        camera.up = camera.right.cross(camera.forward);
    }

    /// Moves the scene with the mouse: to the right and downwards, in heights of the view.
    pub fn pan(&mut self, right: f64, down: f64) {
        let height = self.height_at_pivot();
        let shift = (self.camera.up * down - self.camera.right * right) * height;
        self.camera.eye += shift;
        self.pivot += shift;
    }

    /// Makes the scene appear larger by a factor.
    pub fn zoom(&mut self, factor: f64) {
        if !(factor.is_finite() && factor > 0.0) {
            return;
        }
        if let Projection::Orthographic { height } = &mut self.camera.projection {
            let now = height.unwrap_or(2.0 * self.radius);
            *height = Some((now / factor).clamp(1e-6 * self.radius, 1e3 * self.radius));
            return;
        }
        let distance = self.distance();
        let wanted = (distance / factor).clamp(NEAREST * self.radius, 1e3 * self.radius);
        self.camera.eye += self.camera.forward * (distance - wanted);
    }

    /// Walks: forwards, to the right and upwards, in world units; the pivot comes along.
    pub fn walk(&mut self, step: DVec3) {
        let camera = &mut self.camera;
        let shift = camera.forward * step.x + camera.right * step.y + camera.up * step.z;
        camera.eye += shift;
        self.pivot += shift;
    }

    /// Looks around from where the eye is: to the right and downwards, in heights of the view.
    pub fn look(&mut self, right: f64, down: f64) {
        let distance = self.distance();
        self.pivot = self.camera.eye;
        self.orbit(-0.5 * right, -0.5 * down);
        self.pivot = self.camera.eye + self.camera.forward * distance;
    }

    /// Looks at the pivot from a side, from as far as now.
    pub fn look_along(&mut self, axis: Axis) {
        let (side, up) = axis.frame();
        let distance = self.distance().abs().max(NEAREST * self.radius);
        let camera = &mut self.camera;
        camera.eye = self.pivot + side * distance;
        camera.forward = -side;
        camera.right = camera.forward.cross(up).normalize();
        camera.up = camera.right.cross(camera.forward);
    }

    /// Looks at the whole scene, around `middle`, in the present direction.
    pub fn fit(&mut self, middle: DVec3, aspect: f64) {
        let narrow = aspect.clamp(1e-3, 1.0);
        self.pivot = middle;
        let distance = match &mut self.camera.projection {
            Projection::Perspective { fov_y } => {
                let half = ((0.5 * fov_y.to_radians()).tan() * narrow).atan();
                self.radius / half.sin()
            }
            Projection::Orthographic { height } => {
                *height = Some(2.0 * self.radius / narrow);
                4.0 * self.radius
            }
        };
        self.camera.eye = middle - self.camera.forward * distance;
    }

    /// Changes between parallel and perspective projection; what lies at the pivot keeps its size.
    pub fn toggle_orthographic(&mut self) {
        let height = self.height_at_pivot();
        let (projection, distance) = match self.camera.projection {
            Projection::Perspective { .. } => (
                Projection::Orthographic {
                    height: Some(height),
                },
                4.0 * self.radius,
            ),
            Projection::Orthographic { .. } => (
                Projection::Perspective { fov_y: FOV_Y },
                0.5 * height / (0.5 * FOV_Y.to_radians()).tan(),
            ),
        };
        self.camera.projection = projection;
        self.camera.eye = self.pivot - self.camera.forward * distance;
    }

    /// The camera as graph files describe one.
    #[must_use]
    pub fn described(&self) -> CameraDesc {
        let camera = &self.camera;
        CameraDesc {
            pose: Pose::LookAt {
                eye: camera.eye,
                target: Some(
                    camera.eye + camera.forward * self.distance().abs().max(NEAREST * self.radius),
                ),
            },
            up: camera.up,
            projection: camera.projection,
        }
    }

    /// Where a world position is seen: right and down from the middle, in heights of the view; `None` behind the eye.
    #[must_use]
    pub fn project(&self, position: DVec3) -> Option<[f64; 2]> {
        let from_eye = position - self.camera.eye;
        let depth = from_eye.dot(self.camera.forward);
        let height = match self.camera.projection {
            Projection::Orthographic { height } => height.unwrap_or(2.0 * self.radius),
            Projection::Perspective { fov_y } if depth > 0.0 => {
                2.0 * depth * (0.5 * fov_y.to_radians()).tan()
            }
            Projection::Perspective { .. } => return None,
        };
        Some([
            from_eye.dot(self.camera.right) / height,
            -from_eye.dot(self.camera.up) / height,
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn front() -> Navigation {
        let camera = Camera {
            eye: DVec3::new(0.0, -10.0, 0.0),
            right: DVec3::X,
            up: DVec3::Z,
            forward: DVec3::Y,
            projection: Projection::Perspective { fov_y: 30.0 },
        };
        Navigation::new(camera, &[DVec3::splat(-1.0), DVec3::splat(1.0)])
    }

    fn is_orthonormal(camera: &Camera) -> bool {
        let axes = [camera.right, camera.up, camera.forward];
        axes.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-12)
            && camera.right.cross(camera.forward).distance(camera.up) < 1e-12
    }

    #[test]
    fn an_orbit_keeps_the_distance_and_turns_what_is_in_front_with_the_mouse() {
        let mut at = front();
        let near_side = DVec3::new(0.0, -1.0, 0.0);
        at.orbit(0.1, 0.0);
        // What is in front moves to the right, as the mouse did.
        assert!(at.project(near_side).unwrap()[0] > 0.0);
        let mut at = front();
        at.orbit(0.0, 0.1);
        assert!(at.project(near_side).unwrap()[1] > 0.0);
        for _ in 0..500 {
            at.orbit(0.013, 0.031);
        }
        assert!((at.camera.eye.length() - 10.0).abs() < 1e-9);
        assert!(is_orthonormal(&at.camera));
    }

    #[test]
    fn a_pan_moves_the_pivot_by_exactly_the_drag() {
        let mut at = front();
        let pivot = at.pivot;
        at.pan(0.25, -0.125);
        let [right, down] = at.project(pivot).unwrap();
        assert!((right - 0.25).abs() < 1e-12 && (down + 0.125).abs() < 1e-12);
    }

    #[test]
    fn a_zoom_by_two_doubles_the_size_in_both_projections() {
        for is_orthographic in [false, true] {
            let mut at = front();
            if is_orthographic {
                at.toggle_orthographic();
            }
            let height = at.height_at_pivot();
            at.zoom(2.0);
            assert!((at.height_at_pivot() * 2.0 - height).abs() < 1e-9);
            at.zoom(f64::NAN);
            at.zoom(0.0);
            assert!((at.height_at_pivot() * 2.0 - height).abs() < 1e-9);
            at.zoom(1e30);
            assert!(at.camera.eye.is_finite() && at.height_at_pivot() > 0.0);
        }
    }

    #[test]
    fn projections_change_without_a_jump_at_the_pivot() {
        let mut at = front();
        let side = at.pivot + at.camera.right * 0.7;
        let before = at.project(side).unwrap();
        at.toggle_orthographic();
        let parallel = at.project(side).unwrap();
        at.toggle_orthographic();
        let after = at.project(side).unwrap();
        for (a, b) in [(before, parallel), (before, after)] {
            assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12);
        }
    }

    #[test]
    fn axis_views_look_at_the_pivot_and_fit_holds_the_scene() {
        for (axis, _) in Axis::ALL {
            let mut at = front();
            at.look_along(axis);
            assert!(is_orthonormal(&at.camera));
            at.fit(DVec3::ZERO, 1.0);
            for corner in 0..8 {
                let sign = |bit: u32| if corner & bit == 0 { -1.0 } else { 1.0 };
                let corner = DVec3::new(sign(1), sign(2), sign(4));
                let [right, down] = at.project(corner).unwrap();
                assert!(right.abs() < 0.5 && down.abs() < 0.5);
            }
        }
    }

    #[test]
    fn a_described_camera_is_the_same_camera() {
        let mut at = front();
        at.orbit(0.3, -0.2);
        at.roll(0.4);
        let again = at
            .described()
            .fit(&[DVec3::splat(-1.0), DVec3::splat(1.0)], 1.0);
        for (a, b) in [
            (again.eye, at.camera.eye),
            (again.up, at.camera.up),
            (again.forward, at.camera.forward),
        ] {
            assert!(a.distance(b) < 1e-9);
        }
    }

    #[test]
    fn walking_and_looking_around_leave_the_eye_in_place() {
        let mut at = front();
        at.look(0.2, 0.1);
        assert!(at.camera.eye.distance(DVec3::new(0.0, -10.0, 0.0)) < 1e-12);
        assert!(is_orthonormal(&at.camera));
        let forward = at.camera.forward;
        at.walk(DVec3::new(2.0, 0.0, 0.0));
        assert!(
            at.camera
                .eye
                .distance(DVec3::new(0.0, -10.0, 0.0) + 2.0 * forward)
                < 1e-12
        );
    }
}
