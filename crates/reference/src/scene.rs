//! What is asked of the rays of a picture, as plain values.

use std::fmt::{self, Write};

use crate::background::Background;
use crate::clip::Clip;
use crate::field::Field;
use crate::gradient::Gradients;
use crate::labels::Labels;
use crate::look::{Look, Window};
use crate::rays::Rays;

/// A picture to be computed.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The rays.
    pub rays: Rays,
    /// The scalars.
    pub field: Field,
    /// What the gradient of the field is, for light and normals.
    pub gradients: Gradients,
    /// What of the volume is visible; all where there is none.
    pub clip: Option<Clip>,
    /// What the volume is made of; one thing where there is none.
    pub labels: Option<Labels>,
    /// What a ray shows.
    pub technique: Technique,
    /// What matter looks like: first what is no label's, then what labels name.
    pub looks: Vec<Look>,
    /// What keeps light from surfaces.
    pub shadow: Shadow,
    /// What lies behind.
    pub background: Background,
}

/// What a ray shows.
#[derive(Clone, Debug, PartialEq)]
pub enum Technique {
    /// Emission and absorption.
    VolumeRendering,
    /// The largest scalar.
    Maximum,
    /// The smallest scalar.
    Minimum,
    /// The mean scalar.
    Average,
    /// What scalars absorb of a light behind.
    Xray {
        /// Of each look, the scalars that absorb from nothing to most.
        windows: Vec<Window>,
        /// Absorption of the window's high end per world unit.
        absorption: f64,
        /// Linear colour of what absorbs everything.
        film: [f64; 3],
    },
    /// The isosurfaces of the looks, from front to back.
    Surfaces {
        /// Whether cuts and the box show faces of the solid that the first one bounds.
        has_faces: bool,
        /// Whether emission and absorption lie between them.
        with_matter: bool,
    },
}

/// What keeps light from surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadow {
    /// Nothing.
    #[default]
    None,
    /// The solid that the first isosurface bounds.
    Solid,
    /// What the matter between a point and a light absorbs.
    Matter,
}

impl Scene {
    /// Emission and absorption of a whole volume without light, over nothing.
    #[must_use]
    pub fn unlit(rays: Rays, field: Field, look: Look) -> Self {
        Self {
            rays,
            field,
            gradients: Gradients::default(),
            clip: None,
            labels: None,
            technique: Technique::VolumeRendering,
            looks: vec![look],
            shadow: Shadow::None,
            background: Background::Nothing,
        }
    }

    /// Digest of everything that the picture depends on: of the text that `Debug` prints, which is derived, so that no
    /// member can be forgotten. Floats print all of their digits; a field prints the digest of its samples.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        struct Hashed(blake3::Hasher);
        impl fmt::Write for Hashed {
            fn write_str(&mut self, text: &str) -> fmt::Result {
                self.0.update(text.as_bytes());
                Ok(())
            }
        }
        let mut hashed = Hashed(blake3::Hasher::new());
        // Writing into a hasher cannot fail.
        let _ = write!(hashed, "volgraph reference 4 {self:?}");
        *hashed.0.finalize().as_bytes()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use volgraph_optics::TransferFunction;
    use volgraph_volume::{Grid, Volume, Voxels};

    use super::*;
    use crate::clip::Shape;
    use crate::curve::Kernel;
    use crate::look::{Lamp, Layer, Place, Tone};
    use crate::matter::{Materials, Matter};

    fn scene(last: u8) -> Scene {
        let grid = Grid::axis_aligned([2, 2, 2], DVec3::ONE, DVec3::ZERO);
        let voxels = Voxels::U8(vec![0, 1, 2, 3, 4, 5, 6, last]);
        let field = Field::new(&Volume::new("field", grid, voxels).unwrap());
        let text = "(domain: data, color: (1, 1, 1), extinction: [(0, 0), (1, 1)])";
        let transfer = TransferFunction::parse("matter.ron".as_ref(), text).unwrap();
        let matter = Matter::new(&transfer, (0.0, 1.0), 1.0, &Materials::NONE);
        let rays = Rays {
            eye: DVec3::ZERO,
            right: DVec3::X,
            up: DVec3::Y,
            forward: DVec3::Z,
            half_extent: [1.0; 2],
            is_orthographic: false,
            size: [1, 1],
        };
        Scene::unlit(rays, field, Look::unlit(matter))
    }

    #[test]
    fn whatever_differs_has_another_digest() {
        let changes: [fn(&mut Scene); 16] = [
            |_| {},
            |scene| scene.rays.eye.x += 1e-15,
            |scene| scene.rays.size = [1, 2],
            |scene| scene.field = scene.field.clone().with_kernel(Kernel::Bspline),
            |scene| scene.gradients = Gradients::Central,
            |scene| {
                let sphere = |radius| Shape::Sphere {
                    centre: DVec3::ZERO,
                    radius,
                };
                scene.clip = Some(Clip {
                    shape: sphere(1.0),
                    keeps_outside: true,
                });
            },
            |scene| {
                scene.clip = Some(Clip {
                    shape: Shape::Planes(vec![(DVec3::X, 0.5)]),
                    keeps_outside: false,
                });
            },
            |scene| scene.technique = Technique::Maximum,
            |scene| {
                scene.technique = Technique::Surfaces {
                    has_faces: true,
                    with_matter: false,
                };
            },
            |scene| scene.looks[0].lamps = Some(Vec::new()),
            |scene| {
                scene.looks[0].lamps = Some(vec![Lamp {
                    place: Place::Towards(DVec3::X),
                    color: [1.0; 3],
                }]);
            },
            |scene| scene.looks[0].materials.default.shininess = 2.0,
            |scene| {
                scene.looks[0].layers = vec![Layer {
                    level: 0.5,
                    color: [1.0; 3],
                    opacity: 1.0,
                }];
            },
            |scene| {
                let window = Window {
                    low: 0.0,
                    span: 1.0,
                };
                scene.looks[0].tone = Tone::Window(window, [1.0; 3]);
            },
            |scene| scene.shadow = Shadow::Solid,
            |scene| scene.background = Background::Uniform([0.0; 4]),
        ];
        let mut digests = vec![scene(8).digest()];
        for change in changes {
            let mut scene = scene(7);
            change(&mut scene);
            assert!(scene.digest() == scene.clone().digest());
            digests.push(scene.digest());
        }
        let count = digests.len();
        digests.sort_unstable();
        digests.dedup();
        assert_eq!(digests.len(), count);
    }
}
