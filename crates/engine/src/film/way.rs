//! The way of a camera from key to key.

use glam::{DMat3, DQuat, DVec3};
use volgraph_graph::{Camera, CameraDesc, Plan, Pose, Projection};

use super::spline::at;

/// A value at each key.
type Values<T> = Vec<(f64, T)>;

/// A camera's way.
pub(super) struct Way {
    /// The cameras at the keys, exactly.
    keys: Values<Camera>,
    heading: Heading,
    /// Natural logarithms of the distances from eye to target, so that coming nearer is even, and never through it.
    distances: Values<f64>,
    targets: Values<DVec3>,
    /// Natural logarithms of half of the view's height: at distance 1 in perspective, in world units otherwise.
    half_heights: Values<f64>,
    is_orthographic: bool,
}

/// From where the target is looked at.
enum Heading {
    /// From the angles of an orbit about `up`.
    Orbit {
        up: DVec3,
        azimuths: Values<f64>,
        elevations: Values<f64>,
        rolls: Values<f64>,
    },
    /// With this orientation: from the camera's own axes (right, up, backward) to the world's.
    Free(Values<DQuat>),
}

impl Way {
    /// Through cameras at ascending times, of which there is at least one.
    pub(super) fn new(cameras: &[(f64, &CameraDesc)], plan: &Plan) -> Self {
        let middle = CameraDesc::middle(&plan.corners());
        let keys: Values<Camera> = cameras
            .iter()
            .map(|(time, camera)| (*time, plan.fit(camera)))
            .collect();
        let targets: Values<DVec3> = cameras
            .iter()
            .map(|(time, camera)| {
                let (Pose::Orbit { target, .. } | Pose::LookAt { target, .. }) = camera.pose;
                (*time, target.unwrap_or(middle))
            })
            .collect();
        let distance = |((time, camera), (_, target)): (&(f64, Camera), &(f64, DVec3))| {
            let distance = camera.eye.distance(*target);
            (*time, distance.max(f64::MIN_POSITIVE).ln())
        };
        let half_height = |(time, camera): &(f64, Camera)| {
            let half = match camera.projection {
                Projection::Perspective { fov_y } => (0.5 * fov_y.to_radians()).tan(),
                Projection::Orthographic { height } => 0.5 * height.unwrap_or(1.0),
            };
            (*time, half.max(f64::MIN_POSITIVE).ln())
        };
        Self {
            heading: orbit(cameras).unwrap_or_else(|| Heading::Free(orientations(&keys))),
            distances: keys.iter().zip(&targets).map(distance).collect(),
            half_heights: keys.iter().map(half_height).collect(),
            is_orthographic: keys
                .iter()
                .any(|(_, it)| matches!(it.projection, Projection::Orthographic { .. })),
            keys,
            targets,
        }
    }

    /// The camera at a time; before the first key that of the first, after the last that of the last.
    pub(super) fn camera(&self, time: f64) -> Option<Camera> {
        let (first, last) = (self.keys.first()?, self.keys.last()?);
        let time = time.clamp(first.0, last.0);
        if let Ok(key) = self.keys.binary_search_by(|(it, _)| it.total_cmp(&time)) {
            return Some(self.keys[key].1);
        }
        let target = at(&self.targets, time)?;
        let distance = at(&self.distances, time)?.exp();
        let half_height = at(&self.half_heights, time)?.exp();
        let projection = if self.is_orthographic {
            Projection::Orthographic {
                height: Some(2.0 * half_height),
            }
        } else {
            Projection::Perspective {
                fov_y: 2.0 * half_height.atan().to_degrees(),
            }
        };
        match &self.heading {
            Heading::Orbit {
                up,
                azimuths,
                elevations,
                rolls,
            } => {
                let pose = Pose::Orbit {
                    azimuth: at(azimuths, time)?,
                    elevation: at(elevations, time)?,
                    roll: at(rolls, time)?,
                    distance: Some(distance),
                    target: Some(target),
                    zoom: 1.0,
                };
                let camera = CameraDesc {
                    pose,
                    up: *up,
                    projection,
                };
                // Nothing of it is open, so there is nothing that it would be fitted to.
                Some(camera.fit(&[], 1.0))
            }
            Heading::Free(orientations) => {
                let axes = DMat3::from_quat(at(orientations, time)?);
                Some(Camera {
                    eye: target + distance * axes.z_axis,
                    right: axes.x_axis,
                    up: axes.y_axis,
                    forward: -axes.z_axis,
                    projection,
                })
            }
        }
    }
}

/// The angles, where all cameras are orbits about the same direction.
fn orbit(cameras: &[(f64, &CameraDesc)]) -> Option<Heading> {
    let up = cameras.first()?.1.up;
    let angles = cameras.iter().map(|(time, camera)| match camera.pose {
        Pose::Orbit {
            azimuth,
            elevation,
            roll,
            ..
        } if camera.up == up => Some((*time, [azimuth, elevation, roll])),
        _ => None,
    });
    let angles: Values<[f64; 3]> = angles.collect::<Option<_>>()?;
    let of = |which: usize| angles.iter().map(|(time, it)| (*time, it[which])).collect();
    Some(Heading::Orbit {
        up,
        azimuths: of(0),
        elevations: of(1),
        rolls: of(2),
    })
}

fn orientations(keys: &[(f64, Camera)]) -> Values<DQuat> {
    let of = |camera: &Camera| {
        DQuat::from_mat3(&DMat3::from_cols(camera.right, camera.up, -camera.forward))
    };
    keys.iter().map(|(time, key)| (*time, of(key))).collect()
}
