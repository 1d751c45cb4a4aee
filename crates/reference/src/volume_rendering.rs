//! Emission and absorption along one ray, and the surfaces in it.

use glam::DVec3;

use crate::curve::Curve;
use crate::integral::Light;
use crate::lit::LitCurve;
use crate::look::Look;
use crate::pieces::{Piece, split};
use crate::sight::{Part, Sight};
use crate::surface::{Hit, SurfaceWalk};

/// What is added up along a ray.
pub(crate) struct Walk<'a, 's> {
    sight: &'a Sight<'s>,
    pub(crate) light: Light,
    /// Of the surface at which half of the light is gone; zeros where that is at none.
    pub(crate) normal: DVec3,
    allowance: f64,
    least: f64,
}

/// The light of a ray, to an absolute tolerance. `surfaces` says whether faces and isosurfaces are drawn; no component of
/// what lies behind is larger than `behind`.
pub(crate) fn light<'a, 's>(
    sight: &'a Sight<'s>,
    tolerance: f64,
    with_matter: bool,
    surfaces: Option<bool>,
    behind: f64,
) -> Walk<'a, 's> {
    let looks = sight.scene.looks.iter().map(Look::brightest);
    // The opacity is one of the components.
    let brightest = looks.fold(behind.max(1.0), f64::max);
    let lengths = sight.parts.iter().map(|part| part.far - part.near);
    let mut walk = Walk {
        sight,
        light: Light {
            brightest,
            ..Light::default()
        },
        normal: DVec3::ZERO,
        allowance: 0.5 * tolerance / lengths.sum::<f64>().max(f64::MIN_POSITIVE),
        // What comes behind so little light is below the tolerance.
        least: 0.5 * tolerance / brightest,
    };
    // Shadows change what lamps show, all of them by the same share at most.
    let mut surfaces = surfaces.map(|has_faces| SurfaceWalk::new(has_faces, tolerance / brightest));
    for part in &sight.parts {
        let mut hits = Vec::new();
        sight.walk(part, |curve| {
            hits.clear();
            if let Some(surfaces) = &mut surfaces {
                surfaces.hits(sight, part, curve, &mut hits);
            }
            walk.curve(part, curve, with_matter, &hits)
        });
        if walk.is_done() {
            walk.light.error += brightest * walk.light.transmittance;
            break;
        }
    }
    walk
}

impl<'s> Walk<'_, 's> {
    fn is_done(&self) -> bool {
        self.light.transmittance < self.least
    }

    /// A curve and the surfaces that it meets; whether nothing behind counts any more.
    fn curve(&mut self, part: &Part, curve: &Curve, with_matter: bool, hits: &[Hit]) -> bool {
        let mut from = 0.0;
        let ends = hits.iter().map(|hit| (hit.w, Some(hit)));
        let mut lit = None;
        for (to, hit) in ends.chain([(1.0, None)]) {
            if with_matter && to > from && self.matter(part, curve, (from, to), &mut lit) {
                return true;
            }
            if let Some(hit) = hit {
                let before = self.light.half;
                let distance = curve.distance(to);
                self.light.error +=
                    self.light.transmittance * hit.opacity * self.light.brightest * hit.error;
                self.light.surface(hit.color, hit.opacity, distance);
                if before.is_none() && self.light.half.is_some() {
                    self.normal = hit.normal;
                }
                if self.is_done() {
                    return true;
                }
            }
            from = to;
        }
        false
    }

    /// What lies between two parameters of a curve.
    fn matter(
        &mut self,
        part: &Part,
        curve: &Curve,
        ends: (f64, f64),
        lit: &mut Option<(LitCurve<'s>, Vec<f64>)>,
    ) -> bool {
        let look = self.sight.look(part);
        let Some(matter) = &look.matter else {
            return false;
        };
        split(curve, ends, matter, |piece| {
            if matter.is_clear(piece.part) {
                return self.is_done();
            }
            let Piece { from, to, part: at } = piece;
            let Some(lamps) = &look.lamps else {
                self.light.piece(curve, (from, to), self.allowance, |w| {
                    matter.at(at, curve.at(w))
                });
                return self.is_done();
            };
            // Only once it is needed, and once for all pieces.
            let (lit, splits) = lit.get_or_insert_with(|| {
                let lit = LitCurve::new(self.sight, part, curve, lamps);
                let splits = lit.splits();
                (lit, splits)
            });
            let mut start = from;
            let inside = splits.iter().copied().filter(|w| from < *w && *w < to);
            for end in inside.chain([to]) {
                self.light.piece(curve, (start, end), self.allowance, |w| {
                    let scalar = curve.at(w);
                    let (color, extinction) = matter.at(at, scalar);
                    let material = matter.material(at, scalar);
                    (lit.color(w, color, &material), extinction)
                });
                start = end;
            }
            self.is_done()
        })
    }
}
