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
        let _ = write!(hashed, "volgraph reference 2 {self:?}");
        *hashed.0.finalize().as_bytes()
    }
}
