//! Projections of scalars along one ray.

use crate::look::Window;
use crate::sight::Sight;

/// The extreme scalar of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extreme {
    pub(crate) scalar: f64,
    pub(crate) distance: f64,
    /// Which look its part has.
    pub(crate) look: usize,
}

/// The largest scalar, or the smallest; of equal ones the first. `None` where nothing is visible.
pub(crate) fn extreme(sight: &Sight<'_>, is_largest: bool) -> Option<Extreme> {
    let mut best: Option<Extreme> = None;
    for part in &sight.parts {
        sight.walk(part, |curve| {
            let turns = curve.turns();
            let places = turns.as_slice().iter().copied();
            for w in [0.0].into_iter().chain(places).chain([1.0]) {
                let scalar = curve.at(w);
                let is_better = best.is_none_or(|best| {
                    if is_largest {
                        scalar > best.scalar
                    } else {
                        scalar < best.scalar
                    }
                });
                if is_better {
                    best = Some(Extreme {
                        scalar,
                        distance: curve.distance(w),
                        look: part.look,
                    });
                }
            }
            false
        });
    }
    best
}

/// The mean scalar; `None` where nothing is visible.
pub(crate) fn mean(sight: &Sight<'_>) -> Option<f64> {
    let (mut sum, mut length) = (0.0, 0.0);
    for part in &sight.parts {
        sight.walk(part, |curve| {
            sum += curve.scalar.integral(0.0, 1.0) * (curve.end - curve.start);
            length += curve.end - curve.start;
            false
        });
    }
    (length > 0.0).then(|| sum / length)
}

/// The integral of the windows' shares that are above 0, over world lengths.
pub(crate) fn shares(sight: &Sight<'_>, windows: &[Window]) -> f64 {
    let mut sum = 0.0;
    for part in &sight.parts {
        let Some(window) = windows.get(part.look).or(windows.first()) else {
            continue;
        };
        sight.walk(part, |curve| {
            let length = curve.end - curve.start;
            let scalar = &curve.scalar;
            let below = crate::polynomial::Polynomial::new(&[-window.low]);
            let changes = scalar.plus(&below).sign_changes();
            let mut from = 0.0;
            for to in changes.as_slice().iter().copied().chain([1.0]) {
                if window.share(curve.at(0.5 * (from + to))) > 0.0 {
                    let above = scalar.integral(from, to) - (to - from) * window.low;
                    sum += length * above / window.span;
                }
                from = to;
            }
            false
        });
    }
    sum
}
