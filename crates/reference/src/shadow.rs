//! What keeps a lamp's light from a surface: the solid, all or nothing, or what matter absorbs.
//!
//! A ray towards the lamp goes over the same parts as the eye's. It starts on the surface itself. Where that is the solid's
//! isosurface, the side on which it goes on is that of the field's slope towards the lamp; where it is a cut, the ray
//! starts outside. A surface that is seen from within the solid exchanges solid and empty: only then light may pass a cut.

use glam::DVec3;

use crate::integral::Light;
use crate::look::{Lamp, Place};
use crate::pieces::split;
use crate::rays::Ray;
use crate::scene::Shadow;
use crate::sight::Sight;

/// A ray starts beside a cut by this part of the smallest spacing.
const BESIDE: f64 = 1e-6;

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    pub(crate) world: DVec3,
    /// Unit normal towards the eye.
    pub(crate) normal: DVec3,
    /// Whether it is on a cut or on the box, and not where the field has an isovalue.
    pub(crate) is_face: bool,
}

/// The share of a lamp in a direction, and so far away at most, that reaches a point of a surface.
pub(crate) fn transmittance(
    sight: &Sight<'_>,
    point: &Lit,
    lamp: &Lamp,
    direction: DVec3,
    reach: f64,
    tolerance: f64,
) -> f64 {
    let scene = sight.scene;
    if scene.shadow == Shadow::None {
        return 1.0;
    }
    if scene.shadow == Shadow::Solid && lamp.place == Place::Eye {
        // It reaches what the eye sees.
        return 1.0;
    }
    let beside = BESIDE * scene.field.min_spacing();
    let origin = match (scene.shadow, point.is_face) {
        (Shadow::Solid, true) => point.world + beside * point.normal,
        _ => point.world,
    };
    let ray = Ray { origin, direction };
    // What is behind the eye casts no shadow.
    let reach = match lamp.place {
        Place::Eye => scene.rays.distance_to_eye(origin),
        _ => reach,
    };
    let Some((near, far)) = scene.field.interval(&ray) else {
        return 1.0;
    };
    let far = far.min(reach);
    if far <= near {
        return 1.0;
    }
    let sight = Sight::new(scene, ray, (near, far), near > 0.0);
    if scene.shadow == Shadow::Matter {
        return through(&sight, tolerance);
    }
    f64::from(u8::from(is_free(&sight, point, near)))
}

/// The share of light that matter lets through.
fn through(sight: &Sight<'_>, tolerance: f64) -> f64 {
    let mut light = Light::default();
    let lengths = sight.parts.iter().map(|part| part.far - part.near);
    let allowance = 0.5 * tolerance / lengths.sum::<f64>().max(f64::MIN_POSITIVE);
    for part in &sight.parts {
        let Some(matter) = &sight.look(part).matter else {
            continue;
        };
        sight.walk(part, |curve| {
            split(curve, (0.0, 1.0), matter, |piece| {
                if !matter.is_clear(piece.part) {
                    light.piece(curve, (piece.from, piece.to), allowance, |w| {
                        ([0.0; 3], matter.at(piece.part, curve.at(w)).1)
                    });
                }
                light.transmittance < 0.5 * tolerance
            })
        });
    }
    light.transmittance
}

/// Whether a ray from a point gets to its end without entering the solid from outside.
fn is_free(sight: &Sight<'_>, point: &Lit, near: f64) -> bool {
    let mut is_hollow = false;
    let mut end = near;
    let mut is_start = !point.is_face;
    let mut is_first = true;
    for part in &sight.parts {
        let look = sight.look(part);
        let Some(layer) = look.layers.first() else {
            continue;
        };
        // What is hidden in between lets light through.
        let is_apart = !is_first || part.near > end;
        is_first = false;
        end = part.far;
        let mut is_blocked = false;
        let mut is_begin = true;
        let mut is_solid = false;
        sight.walk(part, |curve| {
            if is_begin {
                is_begin = false;
                if is_start && !is_apart {
                    // On the level itself: the slope says where the ray goes on, and that of the normal on which side
                    // the eye is.
                    is_start = false;
                    let gradient = sight.scene.field.world_gradient(point.world);
                    let sign = if look.is_solid_below { -1.0 } else { 1.0 };
                    is_hollow = sign * gradient.dot(point.normal) > 0.0;
                    is_solid = sign * gradient.dot(sight.ray.direction) > 0.0;
                    if is_solid != is_hollow {
                        is_blocked = true;
                        return true;
                    }
                } else {
                    is_start = false;
                    is_solid = look.is_solid(curve.at(0.0));
                    if is_solid != is_hollow {
                        if !is_hollow {
                            is_blocked = true;
                            return true;
                        }
                        // Light gets in or out by a cut.
                        is_hollow = false;
                    }
                }
            }
            let turns = curve.turns();
            let mut low = 0.0;
            for high in turns.as_slice().iter().copied().chain([1.0]) {
                if look.is_solid(curve.at(high)) != is_solid {
                    // Not the level on which the ray starts.
                    let w = curve.scalar.solve(low, high, layer.level);
                    if curve.distance(w) > 1e-9 * sight.voxel() {
                        is_blocked = true;
                        return true;
                    }
                    is_solid = !is_solid;
                }
                low = high;
            }
            false
        });
        if is_blocked {
            return false;
        }
    }
    true
}
