//! Emission and absorption along one ray.

use crate::field::Field;
use crate::integral::Light;
use crate::matter::Matter;
use crate::pieces::split;
use crate::rays::Ray;

/// The light of a ray between two distances, to an absolute tolerance.
pub(crate) fn light(
    field: &Field,
    matter: &Matter,
    ray: &Ray,
    (near, far): (f64, f64),
    tolerance: f64,
) -> Light {
    let mut light = Light::default();
    let allowance = 0.5 * tolerance / (far - near);
    // What comes behind so little light is below the tolerance.
    let least = 0.5 * tolerance;
    field.walk(ray, (near, far), |cubic| {
        split(cubic, (0.0, 1.0), matter, |piece| {
            if !matter.is_clear(piece.part) {
                light.piece(cubic, (piece.from, piece.to), allowance, |w| {
                    matter.at(piece.part, cubic.at(w))
                });
            }
            light.transmittance < least
        })
    });
    if light.transmittance < least {
        light.error += light.transmittance;
    }
    light
}
