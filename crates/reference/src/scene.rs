//! What is asked of the rays of a picture, as plain values.

use crate::background::Background;
use crate::field::Field;
use crate::matter::Matter;
use crate::rays::Rays;

/// A picture to be computed.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The rays.
    pub rays: Rays,
    /// The scalars.
    pub field: Field,
    /// What a ray shows of them.
    pub technique: Technique,
    /// What lies behind.
    pub background: Background,
}

/// What a ray shows.
#[derive(Clone, Debug)]
pub enum Technique {
    /// Emission and absorption.
    VolumeRendering {
        /// Colours and extinctions.
        matter: Matter,
    },
}

impl Scene {
    /// Digest of everything that the picture depends on.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        hasher.update(b"volgraph reference 1\0");
        hasher.update(&self.field.digest());
        // Plain values print all of their digits.
        hasher.update(format!("{:?}{:?}", self.rays, self.background).as_bytes());
        match &self.technique {
            Technique::VolumeRendering { matter } => {
                hasher.update(b"volume rendering\0");
                hasher.update(&matter.digest());
            }
        }
        *hasher.finalize().as_bytes()
    }
}
