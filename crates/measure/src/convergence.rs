//! A study of convergence: errors of one halving after the other, which of them tell an order, and the order.
//!
//! Errors of a method of order p go like `step^p` only between two ends. At the fine end they meet a floor: the rounding
//! of f32, entries of tables. At the coarse end the first steps are not yet small. [`Convergence::of`] leaves both out by
//! rules that it states for each point, and fits a line to the logarithms of the rest.

use serde::Serialize;

use crate::order;

/// An error at a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StudyPoint {
    /// The step, in any unit.
    pub step: f64,
    /// The error, 0 or more.
    pub error: f64,
    /// Whether it is fitted, and if not, why.
    pub role: PointRole,
}

/// What a point is to the fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PointRole {
    /// On the line.
    Fitted,
    /// Less than [`ABOVE_FLOOR`] times the floor: it has as much of the floor as of the method.
    Floor,
    /// The step is too coarse: the slope there is more than [`COARSE_SLOPE`] beside that of the finer ones.
    Coarse,
}

/// What is left out is less than so many times the floor.
pub const ABOVE_FLOOR: f64 = 4.0;

/// A slope so far from the median of the finer ones is not on their line.
pub const COARSE_SLOPE: f64 = 0.15;

/// An order needs so many points.
pub const LEAST_POINTS: usize = 3;

/// Where the slope of a halving is below this, or below this share of the steepest before, the error has stopped falling.
const STANDSTILL_SLOPE: f64 = 0.5;
const STANDSTILL_SHARE: f64 = 0.4;

/// Errors at halved steps, and their order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Convergence {
    /// From the coarsest step to the finest.
    pub points: Vec<StudyPoint>,
    /// The slope of the fitted points; `None` where they are fewer than [`LEAST_POINTS`].
    pub order: Option<f64>,
    /// Where the error stops falling, if it does and that is low enough to be rounding or tables.
    pub floor: Option<f64>,
    /// Whether all of it is floor: the method is exact, as far as can be told.
    pub is_exact: bool,
}

impl Convergence {
    /// The study of errors at steps from the coarsest to the finest, each half of the one before. Errors up to `rounding`
    /// are floor in any case; where errors stop falling at `highest_floor` or below, that is the floor. Higher up a
    /// standstill is no floor but what the method does, and counts against it.
    #[must_use]
    pub fn of(steps: &[f64], errors: &[f64], rounding: f64, highest_floor: f64) -> Self {
        let mut points: Vec<StudyPoint> = steps
            .iter()
            .zip(errors)
            .map(|(&step, &error)| StudyPoint {
                step,
                error,
                role: PointRole::Fitted,
            })
            .collect();
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let slope =
            |at: usize| (errors[at] / errors[at + 1]).ln() / (steps[at] / steps[at + 1]).ln();
        let mut steepest = 0.0_f64;
        let stands = (0..errors.len().saturating_sub(1)).any(|at| {
            let slope = slope(at);
            let is_flat = slope < STANDSTILL_SLOPE || slope < STANDSTILL_SHARE * steepest;
            steepest = steepest.max(slope);
            is_flat && errors[at].max(errors[at + 1]) <= highest_floor
        });
        let floor = (stands || least <= rounding).then(|| least.max(rounding));
        if let Some(floor) = floor {
            // From the first point at the floor on: what follows is floor as well, whatever it does.
            let first = points
                .iter()
                .position(|point| point.error < ABOVE_FLOOR * floor);
            for point in &mut points[first.unwrap_or(steps.len())..] {
                point.role = PointRole::Floor;
            }
        }
        let used = points
            .iter()
            .take_while(|point| point.role == PointRole::Fitted)
            .count();
        let slopes: Vec<f64> = (0..used.saturating_sub(1)).map(slope).collect();
        let mut coarse = 0;
        while used - coarse > LEAST_POINTS
            && (slopes[coarse] - median(&slopes[coarse + 1..])).abs() > COARSE_SLOPE
        {
            points[coarse].role = PointRole::Coarse;
            coarse += 1;
        }
        let fitted = coarse..used;
        let order = (fitted.len() >= LEAST_POINTS)
            .then(|| order(&steps[fitted.clone()], &errors[fitted]))
            .flatten();
        Self {
            is_exact: used == 0 && !points.is_empty(),
            points,
            order,
            floor,
        }
    }

    /// The points that are fitted.
    pub fn fitted(&self) -> impl Iterator<Item = &StudyPoint> {
        let points = self.points.iter();
        points.filter(|point| point.role == PointRole::Fitted)
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 {
        sorted[middle]
    } else {
        0.5 * (sorted[middle - 1] + sorted[middle])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(errors: &[f64]) -> Convergence {
        let steps: Vec<f64> = (0..errors.len()).map(|i| 0.5_f64.powi(i as i32)).collect();
        Convergence::of(&steps, errors, 1e-7, 2e-5)
    }

    fn roles(study: &Convergence) -> String {
        let letter = |point: &StudyPoint| match point.role {
            PointRole::Fitted => 'f',
            PointRole::Floor => '-',
            PointRole::Coarse => 'c',
        };
        study.points.iter().map(letter).collect()
    }

    fn close(study: &Convergence, order: f64) {
        let found = study.order.unwrap();
        assert!((found - order).abs() < 0.01, "{study:?}");
    }

    #[test]
    fn powers_have_their_order_and_floors_are_left_out() {
        let whole = study(&[0.4, 0.1, 0.025, 0.00625, 0.0015625]);
        close(&whole, 2.0);
        assert_eq!((roles(&whole).as_str(), whole.floor), ("fffff", None));
        // Order 4 meets rounding.
        let quartic = study(&[1.6e-2, 1e-3, 6.25e-5, 3.9e-6, 3e-7, 2.9e-7]);
        close(&quartic, 4.0);
        assert_eq!(roles(&quartic), "ffff--");
        // A floor of tables, from which the error rises and falls again.
        let table = study(&[0.4, 0.1, 0.025, 6e-6, 8e-6, 7e-6]);
        assert_eq!(roles(&table), "fff---");
        close(&table, 2.0);
        let exact = study(&[1e-7, 2e-7, 0.0, 1e-7]);
        assert!(exact.is_exact && exact.order.is_none(), "{exact:?}");
    }

    #[test]
    fn coarse_steps_are_left_out_as_long_as_enough_remain() {
        let late = study(&[0.5, 0.4, 0.1, 0.025, 0.00625]);
        assert_eq!(roles(&late), "cffff");
        close(&late, 2.0);
        let three = study(&[0.5, 0.4, 0.1]);
        assert_eq!(roles(&three), "fff");
    }

    #[test]
    fn what_stops_falling_high_up_counts_against_the_method() {
        // To a wrong limit, a hundredth off.
        let wrong = study(&[0.4, 0.1, 0.027, 0.011, 0.01, 0.01]);
        assert!(
            wrong.floor.is_none() && wrong.order.unwrap() < 0.5,
            "{wrong:?}"
        );
        // An order that falls to 1 at the fine end is 1.
        let mixed = study(&[1.0, 0.26, 0.08, 0.03, 0.0125, 0.0056]);
        assert!(mixed.order.unwrap() < 1.5, "{mixed:?}");
        // Rising errors have a negative order.
        assert!(study(&[0.1, 0.2, 0.4, 0.8]).order.unwrap() < -0.9);
        // Two points tell none.
        assert_eq!(study(&[0.4, 0.1, 1e-7, 1e-7]).order, None);
    }
}
