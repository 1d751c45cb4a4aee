//! A camera as a graph writes it: what [`crate::read::camera_text`] reads.

use glam::DVec3;

use crate::camera::{CameraDesc, Pose, Projection};

impl CameraDesc {
    /// The camera in the words of a graph file, such as `orbit(azimuth: 40.0, elevation: 25.0)`; what is as it is anyway is
    /// left out. Reading it gives the same camera.
    #[must_use]
    pub fn to_ron(&self) -> String {
        let mut fields: Vec<String> = Vec::new();
        let vector = |v: DVec3| format!("({:?}, {:?}, {:?})", v.x, v.y, v.z);
        let (name, target) = match &self.pose {
            Pose::Orbit {
                azimuth,
                elevation,
                roll,
                distance,
                target,
                zoom,
            } => {
                fields.push(format!("azimuth: {azimuth:?}"));
                fields.push(format!("elevation: {elevation:?}"));
                if *roll != 0.0 {
                    fields.push(format!("roll: {roll:?}"));
                }
                fields.extend(distance.map(|distance| format!("distance: {distance:?}")));
                if *zoom != 1.0 {
                    fields.push(format!("zoom: {zoom:?}"));
                }
                ("orbit", target)
            }
            Pose::LookAt { eye, target } => {
                fields.push(format!("eye: {}", vector(*eye)));
                ("look_at", target)
            }
        };
        let default = Self::default();
        fields.extend(target.map(|target| format!("target: {}", vector(target))));
        if self.up != default.up {
            fields.push(format!("up: {}", vector(self.up)));
        }
        match self.projection {
            projection if projection == default.projection => {}
            Projection::Perspective { fov_y } => fields.push(format!("fov_y: {fov_y:?}")),
            Projection::Orthographic { height } => {
                fields.push("projection: orthographic".to_owned());
                fields.extend(height.map(|height| format!("height: {height:?}")));
            }
        }
        format!("{name}({})", fields.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;
    use crate::read;

    fn any_camera() -> impl Strategy<Value = CameraDesc> {
        let number = || -1e6..1e6_f64;
        let vector = || [number(), number(), number()].prop_map(DVec3::from_array);
        let target = || proptest::option::of(vector());
        let length = || proptest::option::of(1e-6..1e6_f64);
        let orbit = (
            [number(), number(), number()],
            length(),
            target(),
            0.1..9.0_f64,
        );
        let orbit =
            orbit.prop_map(
                |([azimuth, elevation, roll], distance, target, zoom)| Pose::Orbit {
                    azimuth,
                    elevation,
                    roll,
                    distance,
                    target,
                    // What is not fitted has no zoom.
                    zoom: 1.0 + f64::from(u8::from(distance.is_none())) * (zoom - 1.0),
                },
            );
        let look_at = (vector(), target()).prop_map(|(eye, target)| Pose::LookAt { eye, target });
        let projection = prop_oneof![
            (1.0..179.0_f64).prop_map(|fov_y| Projection::Perspective { fov_y }),
            Just(Projection::Perspective { fov_y: 30.0 }),
            Just(Projection::Orthographic { height: None }),
        ];
        (prop_oneof![orbit, look_at], vector(), projection).prop_map(|(pose, up, projection)| {
            // A distance fits nothing in perspective, a height nothing in parallel projection.
            let is_fitted = matches!(pose, Pose::Orbit { zoom, .. } if zoom != 1.0);
            let projection = match projection {
                Projection::Orthographic { .. } if !is_fitted => {
                    Projection::Orthographic { height: Some(2.5) }
                }
                other => other,
            };
            CameraDesc {
                pose,
                up,
                projection,
            }
        })
    }

    proptest! {
        #[test]
        fn a_camera_is_read_as_it_is_written(camera in any_camera()) {
            let read = read::camera_text(Path::new("t.ron"), &camera.to_ron());
            prop_assert_eq!(read.map_err(|found| found.to_string()), Ok(camera));
        }
    }
}
