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
    /// What was met up to each stop, where somebody asks.
    record: Option<Record>,
}

/// The colour and the transmittance at evenly spaced stops of each curve, for as long as anything counts.
pub(crate) struct Record {
    /// Stops of a curve, its end included.
    pub(crate) per_curve: usize,
    pub(crate) stops: Vec<([f64; 3], f64)>,
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
    recorded_light(sight, tolerance, with_matter, surfaces, behind, None).0
}

/// The same, and what was met up to the stops of a record.
pub(crate) fn recorded_light<'a, 's>(
    sight: &'a Sight<'s>,
    tolerance: f64,
    with_matter: bool,
    surfaces: Option<bool>,
    behind: f64,
    record: Option<Record>,
) -> (Walk<'a, 's>, Option<Record>) {
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
        record,
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
    let record = walk.record.take();
    (walk, record)
}

impl<'s> Walk<'_, 's> {
    fn is_done(&self) -> bool {
        self.light.transmittance < self.least
    }

    /// A curve and the surfaces that it meets; whether nothing behind counts any more.
    fn curve(&mut self, part: &Part, curve: &Curve, with_matter: bool, hits: &[Hit]) -> bool {
        let mut from = 0.0;
        let mut lit = None;
        let mut hits = hits.iter().peekable();
        let stops = self.record.as_ref().map_or(1, |record| record.per_curve);
        for stop in 1..=stops {
            let end = stop as f64 / stops as f64;
            while let Some(hit) = hits.next_if(|hit| hit.w <= end) {
                if with_matter && hit.w > from && self.matter(part, curve, (from, hit.w), &mut lit)
                {
                    return true;
                }
                from = hit.w;
                if self.surface(curve, hit) {
                    return true;
                }
            }
            if with_matter && end > from && self.matter(part, curve, (from, end), &mut lit) {
                return true;
            }
            from = end;
            if let Some(record) = &mut self.record {
                let stop = (self.light.color, self.light.transmittance);
                record.stops.push(stop);
            }
        }
        false
    }

    /// A surface that a curve meets; whether nothing behind counts any more.
    fn surface(&mut self, curve: &Curve, hit: &Hit) -> bool {
        let before = self.light.half;
        self.light.error +=
            self.light.transmittance * hit.opacity * self.light.brightest * hit.error;
        self.light
            .surface(hit.color, hit.opacity, curve.distance(hit.w));
        if before.is_none() && self.light.half.is_some() {
            self.normal = hit.normal;
        }
        self.is_done()
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
