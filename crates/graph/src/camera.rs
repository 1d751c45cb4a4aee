//! Cameras: how a graph file describes one, how it fits the volumes, and the numbers that shaders get.
//!
//! A [`CameraDesc`] (orbit or look-at, parts left open) becomes a [`Camera`] once the box of all volumes is
//! known. For a picture size it splits in two: the [`Lens`] (projection and size, the same for all poses, so that
//! what depends on the lens alone is not drawn again when the camera moves) and the pose. A ray through pixel
//! position (x, y) in -1..1 (y up) is, in perspective, `eye`, `forward + x·half_width·right + y·half_height·up`;
//! in orthographic projection `eye + x·half_width·right + y·half_height·up`, `forward`.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// How points are projected.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Projection {
    /// Perspective with the vertical field of view in degrees, 0 < fov < 180.
    Perspective {
        /// Vertical field of view, degrees.
        fov_y: f64,
    },
    /// Orthographic; the height of the view in world units, or fitted to the volumes where `None`.
    Orthographic {
        /// Height of the view, world units.
        height: Option<f64>,
    },
}

/// Where the camera stands, as a graph file says it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Pose {
    /// Around a target. At azimuth and elevation 0 with `up` +z the camera looks along +y (for a patient in LPS
    /// coordinates: at the face); a growing azimuth moves it anticlockwise as seen from `up`.
    Orbit {
        /// Degrees around `up`.
        azimuth: f64,
        /// Degrees above the plane across `up`, -90 to 90.
        elevation: f64,
        /// Degrees around the viewing direction.
        roll: f64,
        /// World units from the target; fitted to the volumes where `None`.
        distance: Option<f64>,
        /// World position looked at; the middle of the volumes where `None`.
        target: Option<DVec3>,
        /// What is fitted is divided by this: at 2 the volumes look twice as large.
        zoom: f64,
    },
    /// From an eye to a target.
    LookAt {
        /// World position of the eye.
        eye: DVec3,
        /// World position looked at; the middle of the volumes where `None`.
        target: Option<DVec3>,
    },
}

/// A camera as a graph file or the command line describes it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraDesc {
    /// Where it stands.
    pub pose: Pose,
    /// The direction that is up in the picture.
    pub up: DVec3,
    /// How it projects.
    pub projection: Projection,
}

impl Default for CameraDesc {
    fn default() -> Self {
        Self {
            pose: Pose::Orbit {
                azimuth: 30.0,
                elevation: 20.0,
                roll: 0.0,
                distance: None,
                target: None,
                zoom: 1.0,
            },
            up: DVec3::Z,
            projection: Projection::Perspective { fov_y: 30.0 },
        }
    }
}

/// A camera with nothing left open. The three axes are orthonormal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// World position of the eye.
    pub eye: DVec3,
    /// World direction to the right of the picture.
    pub right: DVec3,
    /// World direction to the top of the picture.
    pub up: DVec3,
    /// World direction into the picture.
    pub forward: DVec3,
    /// How it projects; an orthographic height is set.
    pub projection: Projection,
}

/// Projection and picture size: what stays when the camera moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Lens {
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// The first pixel of what is drawn of it.
    pub corner: [u32; 2],
    /// Width and height of what is drawn of it.
    pub extent: [u32; 2],
    /// Half the width and height of the view: at distance 1 in perspective, in world units otherwise.
    pub half_extent: [f64; 2],
    /// Whether rays are parallel.
    pub is_orthographic: bool,
}

/// Everything of a frame that is not in the graph: the camera and the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Width and height of what is drawn, in pixels.
    pub size: [u32; 2],
    /// Of which picture that is a window; the whole picture where `None`.
    pub window: Option<Window>,
}

/// Where a part of a picture is: what is drawn there is what the whole picture has there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Window {
    /// Width and height of the whole picture in pixels.
    pub whole: [u32; 2],
    /// The first pixel of the part, from the left and from the top.
    pub corner: [u32; 2],
}

impl CameraDesc {
    fn zoom(&self) -> f64 {
        match self.pose {
            Pose::Orbit { zoom, .. } => zoom,
            Pose::LookAt { .. } => 1.0,
        }
    }

    /// What a camera looks at that names no target: the middle of `corners`, the origin where there are none.
    #[must_use]
    pub fn middle(corners: &[DVec3]) -> DVec3 {
        bounding_sphere(corners).0
    }

    /// Fits what is open to `corners`, the corners of all volumes' boxes in world space (a unit cube around the
    /// origin where there are none), for a picture of the given width over height.
    #[must_use]
    pub fn fit(&self, corners: &[DVec3], aspect: f64) -> Camera {
        let (middle, radius) = bounding_sphere(corners);
        // The view must hold the sphere in its narrower direction.
        let narrow = aspect.min(1.0);
        let (eye, target, up) = match &self.pose {
            Pose::LookAt { eye, target } => (*eye, target.unwrap_or(middle), self.up),
            Pose::Orbit {
                azimuth,
                elevation,
                roll,
                distance,
                target,
                zoom,
            } => {
                let target = target.unwrap_or(middle);
                let distance = distance.unwrap_or_else(|| match self.projection {
                    Projection::Perspective { fov_y } => {
                        let half = ((fov_y.to_radians() * 0.5).tan() * narrow).atan();
                        radius / half.sin() / zoom
                    }
                    Projection::Orthographic { .. } => 4.0 * radius,
                });
                let up = self.up.normalize_or(DVec3::Z);
                let front = front_of(up);
                let side = up.cross(front);
                let (azimuth_sin, azimuth_cos) = azimuth.to_radians().sin_cos();
                let (elevation_sin, elevation_cos) = elevation.to_radians().sin_cos();
                let level = front * azimuth_cos + side * azimuth_sin;
                let to_eye = level * elevation_cos + up * elevation_sin;
                // Up stays defined at the poles: it is the derivative along the elevation.
                let tilted_up = up * elevation_cos - level * elevation_sin;
                let right = tilted_up.cross(to_eye);
                let (roll_sin, roll_cos) = roll.to_radians().sin_cos();
                let rolled_up = tilted_up * roll_cos + right * roll_sin;
                (target + to_eye * distance, target, rolled_up)
            }
        };
        let forward = (target - eye).normalize_or(DVec3::Y);
        let mut right = forward.cross(up).normalize_or_zero();
        if right == DVec3::ZERO {
            right = forward.any_orthonormal_vector();
        }
        let projection = match self.projection {
            Projection::Orthographic { height: None } => Projection::Orthographic {
                height: Some(2.0 * radius / narrow / self.zoom()),
            },
            given => given,
        };
        Camera {
            eye,
            right,
            up: right.cross(forward),
            forward,
            projection,
        }
    }
}

impl View {
    /// The part of the view that a moving camera does not change.
    #[must_use]
    pub fn lens(&self) -> Lens {
        let Window { whole, corner } = self.window.unwrap_or(Window {
            whole: self.size,
            corner: [0; 2],
        });
        let aspect = f64::from(whole[0]) / f64::from(whole[1].max(1));
        let (half_height, is_orthographic) = match self.camera.projection {
            Projection::Perspective { fov_y } => ((fov_y.to_radians() * 0.5).tan(), false),
            Projection::Orthographic { height } => (height.unwrap_or(1.0) * 0.5, true),
        };
        Lens {
            size: whole,
            corner,
            extent: self.size,
            half_extent: [half_height * aspect, half_height],
            is_orthographic,
        }
    }

    /// The pixel rectangle `[x, y, width, height]` of what is drawn that holds the projection of `corners`; all of it
    /// where one of them is not in front of the eye; `None` where all of it is outside.
    #[must_use]
    pub fn pixel_bounds(&self, corners: &[DVec3]) -> Option<[u32; 4]> {
        let lens = self.lens();
        let [width, height] = self.size.map(f64::from);
        let [whole_width, whole_height] = lens.size.map(f64::from);
        let [left, top] = lens.corner.map(f64::from);
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in corners {
            let from_eye = *corner - self.camera.eye;
            let depth = from_eye.dot(self.camera.forward);
            if !lens.is_orthographic && depth <= 1e-6 * from_eye.length() {
                return Some([0, 0, self.size[0], self.size[1]]);
            }
            let scale = if lens.is_orthographic {
                1.0
            } else {
                1.0 / depth
            };
            let x = from_eye.dot(self.camera.right) * scale / lens.half_extent[0];
            let y = from_eye.dot(self.camera.up) * scale / lens.half_extent[1];
            let pixel = [
                (x + 1.0) * 0.5 * whole_width - left,
                (1.0 - y) * 0.5 * whole_height - top,
            ];
            for axis in 0..2 {
                lo[axis] = lo[axis].min(pixel[axis]);
                hi[axis] = hi[axis].max(pixel[axis]);
            }
        }
        // One pixel wider on each side, so that rounding never loses a ray that grazes the box.
        let x0 = (lo[0].floor() - 1.0).clamp(0.0, width);
        let y0 = (lo[1].floor() - 1.0).clamp(0.0, height);
        let x1 = (hi[0].ceil() + 1.0).clamp(0.0, width);
        let y1 = (hi[1].ceil() + 1.0).clamp(0.0, height);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the picture, whose size is u32"
        )]
        let bounds = [
            x0 as u32,
            y0 as u32,
            (x1 - x0).max(0.0) as u32,
            (y1 - y0).max(0.0) as u32,
        ];
        (bounds[2] > 0 && bounds[3] > 0).then_some(bounds)
    }
}

/// The level direction from which an orbit at azimuth 0 looks: -y for `up` = ±z, else the level part of +z.
fn front_of(up: DVec3) -> DVec3 {
    let wanted = if up.z.abs() > 0.9 {
        DVec3::NEG_Y
    } else {
        DVec3::Z
    };
    (wanted - up * wanted.dot(up)).normalize_or(DVec3::X)
}

fn bounding_sphere(corners: &[DVec3]) -> (DVec3, f64) {
    if corners.is_empty() {
        return (DVec3::ZERO, 0.75_f64.sqrt());
    }
    let lo = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let hi = corners
        .iter()
        .copied()
        .fold(DVec3::NEG_INFINITY, DVec3::max);
    let middle = (lo + hi) * 0.5;
    let radius = corners
        .iter()
        .map(|corner| corner.distance(middle))
        .fold(0.0, f64::max);
    (middle, radius.max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests;
