//! What one ray meets, point by point: the scalar, what it is made of, and what the ray would show if it ended there.

use serde::Serialize;

use crate::curve::Curve;
use crate::render::{ReferenceError, check, over, pixel, sight};
use crate::scene::{Scene, Technique};
use crate::sight::{Part, Sight};
use crate::volume_rendering::{Record, recorded_light};

/// What one ray meets.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Profile {
    /// World distances from the ray's origin where it enters and leaves the volume's box.
    pub interval: [f64; 2],
    /// Points from front to back, in what is visible; the last of a part and the first of the next may be at one place.
    pub points: Vec<ProfilePoint>,
    /// Linear premultiplied colour of all of it, before the background.
    pub color: [f64; 4],
    /// The same over the background.
    pub over: [f64; 4],
    /// Bound of the absolute error of both.
    pub error: f64,
}

/// A point of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProfilePoint {
    /// World distance from the ray's origin.
    pub distance: f64,
    /// The scalar, in data units.
    pub scalar: f64,
    /// Linear colour that its matter emits, before light falls on it; zeros where the technique shows no matter.
    pub emission: [f64; 3],
    /// Extinction of its matter per world unit; 0 where the technique shows no matter.
    pub extinction: f64,
    /// Linear premultiplied colour of all up to here.
    pub color: [f64; 3],
    /// Share of the light behind that still reaches the eye.
    pub transmittance: f64,
}

/// Points of a curve at most.
const MOST_PER_CURVE: usize = 64;

/// What the ray of a pixel (column and row, from the top) meets, at about `points` points; each cell has one at least.
/// Colours are to an absolute tolerance, but for those up to a point inside of an X-ray, which are for the eye. `None`
/// where the ray misses the volume.
///
/// # Errors
/// [`ReferenceError::Tolerance`].
pub fn profile(
    scene: &Scene,
    [x, y]: [u32; 2],
    tolerance: f64,
    points: usize,
) -> Result<Option<Profile>, ReferenceError> {
    check(tolerance)?;
    let Some((interval, sight)) = sight(scene, x, y) else {
        return Ok(None);
    };
    let mut curves = 0_usize;
    for part in &sight.parts {
        sight.walk(part, |_| {
            curves += 1;
            false
        });
    }
    let per_curve = points.div_ceil(curves.max(1)).clamp(1, MOST_PER_CURVE);
    let mut so_far = SoFar::new(&sight, tolerance, per_curve);
    let mut found = Vec::with_capacity(curves * per_curve + sight.parts.len());
    for part in &sight.parts {
        let mut is_first = true;
        sight.walk(part, |curve| {
            let mut add = |w: f64, (color, transmittance): ([f64; 3], f64)| {
                let scalar = curve.at(w);
                let (emission, extinction) = matter(&sight, part, scalar);
                found.push(ProfilePoint {
                    distance: interval[0] + curve.distance(w),
                    scalar,
                    emission,
                    extinction,
                    color,
                    transmittance,
                });
            };
            if is_first {
                add(0.0, so_far.now);
                is_first = false;
            }
            for stop in 0..per_curve {
                let [from, to] = [stop, stop + 1].map(|stop| stop as f64 / per_curve as f64);
                so_far.go_on(&sight, part, curve, (from, to));
                add(to, so_far.now);
            }
            false
        });
    }
    let whole = pixel(scene, x, y, tolerance);
    Ok(Some(Profile {
        interval,
        points: found,
        color: whole.color,
        over: over(scene, &whole, x, y),
        error: whole.error,
    }))
}

/// Emission and extinction of a scalar, where the technique shows matter.
fn matter(sight: &Sight<'_>, part: &Part, scalar: f64) -> ([f64; 3], f64) {
    let shows_matter = matches!(
        sight.scene.technique,
        Technique::VolumeRendering
            | Technique::Surfaces {
                with_matter: true,
                ..
            }
    );
    match &sight.look(part).matter {
        Some(matter) if shows_matter => matter.at(matter.part_of(scalar), scalar),
        _ => ([0.0; 3], 0.0),
    }
}

/// What a ray would show if it ended here.
struct SoFar {
    /// Colour and transmittance.
    now: ([f64; 3], f64),
    /// Of what is composited, at the stops to come.
    stops: std::vec::IntoIter<([f64; 3], f64)>,
    /// The same behind the last of them, where nothing counts any more.
    last: Option<([f64; 3], f64)>,
    best: Option<f64>,
    sum: f64,
    length: f64,
}

impl SoFar {
    fn new(sight: &Sight<'_>, tolerance: f64, per_curve: usize) -> Self {
        let composited = match sight.scene.technique {
            Technique::VolumeRendering => Some((true, None)),
            Technique::Surfaces {
                has_faces,
                with_matter,
            } => Some((with_matter, Some(has_faces))),
            _ => None,
        };
        let recorded = composited.map(|(with_matter, surfaces)| {
            let record = Record {
                per_curve,
                stops: Vec::new(),
            };
            recorded_light(sight, tolerance, with_matter, surfaces, 1.0, Some(record))
        });
        let last = recorded.as_ref().map(|(walk, _)| {
            let light = &walk.light;
            (light.color, light.transmittance)
        });
        let stops = recorded.and_then(|(_, record)| record);
        Self {
            now: ([0.0; 3], 1.0),
            stops: stops
                .map_or_else(Vec::new, |record| record.stops)
                .into_iter(),
            last,
            best: None,
            sum: 0.0,
            length: 0.0,
        }
    }

    /// From one parameter of a curve to another.
    fn go_on(&mut self, sight: &Sight<'_>, part: &Part, curve: &Curve, (from, to): (f64, f64)) {
        let length = (to - from) * (curve.end - curve.start);
        let toned = |scalar: f64| {
            let [r, g, b, a] = sight.look(part).toned(scalar);
            ([r, g, b], 1.0 - a)
        };
        match &sight.scene.technique {
            Technique::VolumeRendering | Technique::Surfaces { .. } => {
                self.now = self.stops.next().or(self.last).unwrap_or(self.now);
            }
            technique @ (Technique::Maximum | Technique::Minimum) => {
                let is_largest = *technique == Technique::Maximum;
                let turns = curve.turns();
                let between = turns.as_slice().iter().filter(|w| from < **w && **w < to);
                for w in [from].into_iter().chain(between.copied()).chain([to]) {
                    let scalar = curve.at(w);
                    let is_better = self.best.is_none_or(|best| {
                        if is_largest {
                            scalar > best
                        } else {
                            scalar < best
                        }
                    });
                    if is_better {
                        self.best = Some(scalar);
                        self.now = toned(scalar);
                    }
                }
            }
            Technique::Average => {
                self.sum += curve.scalar.integral(from, to) * (curve.end - curve.start);
                self.length += length;
                self.now = sight
                    .scene
                    .looks
                    .first()
                    .filter(|_| self.length > 0.0)
                    .map_or(self.now, |own| {
                        let [r, g, b, a] = own.toned(self.sum / self.length);
                        ([r, g, b], 1.0 - a)
                    });
            }
            Technique::Xray {
                windows,
                absorption,
                film,
            } => {
                let Some(window) = windows.get(part.look).or(windows.first()) else {
                    return;
                };
                let share = |w: f64| window.share(curve.at(w)).max(0.0);
                // Simpson's rule.
                self.sum +=
                    length / 6.0 * (share(from) + 4.0 * share(0.5 * (from + to)) + share(to));
                let opacity = -(-absorption * self.sum).exp_m1();
                self.now = (film.map(|channel| channel * opacity), 1.0 - opacity);
            }
        }
    }
}
