//! What keeps a lamp's light from a surface.

use glam::DVec3;

use crate::look::Lamp;
use crate::scene::Shadow;
use crate::sight::{Part, Sight};

/// The share of a lamp that reaches a point of a surface.
pub(crate) fn transmittance(
    sight: &Sight<'_>,
    _part: &Part,
    _world: DVec3,
    _normal: DVec3,
    _lamp: &Lamp,
    _direction: DVec3,
    _reach: f64,
) -> f64 {
    match sight.scene.shadow {
        Shadow::None => 1.0,
        Shadow::Solid | Shadow::Matter => 1.0,
    }
}
