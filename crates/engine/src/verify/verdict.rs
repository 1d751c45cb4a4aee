//! Whether a measured order is as declared, and why it is not told where it is not.

use serde::Serialize;
use volgraph_measure::Convergence;

/// What a measured order is to a declared one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing is declared.
    Reported,
    /// It is as declared.
    Holds,
    /// It is higher than declared.
    Higher,
    /// Only floor was met: exact, as far as can be told.
    Exact,
    /// It is below.
    Below,
    /// It is not told, and [`Untold`] says why.
    Untold,
}

/// Why an order is not told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Untold {
    /// In the coarsest picture, no pixel has the quantity that what it is held against has as well.
    Absent,
    /// Pictures are held against finer ones, and all are the same: what is halved has no part in them.
    Unchanged,
    /// Too few errors lie above the floor.
    TooFew,
}

impl Untold {
    /// Why a study tells no order, if it tells none; what is exact is told. `is_next` says that no truth is known, so that
    /// pictures that never change are no sign of being right.
    pub(super) fn of(convergence: &Convergence, is_next: bool) -> Option<Self> {
        let points = &convergence.points;
        if points.is_empty() {
            Some(Self::Absent)
        } else if is_next && points.iter().all(|point| point.error == 0.0) {
            Some(Self::Unchanged)
        } else if convergence.order.is_none() && !convergence.is_exact {
            Some(Self::TooFew)
        } else {
            None
        }
    }
}

impl Verdict {
    /// Of what is declared, as far as this scene can show it.
    pub(super) fn of(
        convergence: &Convergence,
        untold: Option<Untold>,
        expected: Option<f64>,
        tolerance: f64,
    ) -> Self {
        let Some(expected) = expected else {
            return Self::Reported;
        };
        match convergence.order {
            _ if untold.is_some() => Self::Untold,
            // What is not untold is exact.
            None => Self::Exact,
            Some(order) if order < expected - tolerance => Self::Below,
            Some(order) if order > expected + tolerance => Self::Higher,
            Some(_) => Self::Holds,
        }
    }

    /// Whether it speaks against the graph.
    #[must_use]
    pub fn is_failure(self) -> bool {
        matches!(self, Self::Below | Self::Untold)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(errors: &[f64]) -> Convergence {
        let steps: Vec<f64> = (0..errors.len()).map(|i| 0.5_f64.powi(i as i32)).collect();
        Convergence::of(&steps, errors, 1e-7, 2e-5)
    }

    #[test]
    fn what_is_not_told_does_not_hold() {
        for (errors, is_next, untold, verdict) in [
            (&[][..], false, Some(Untold::Absent), Verdict::Untold),
            (&[0.0; 4], true, Some(Untold::Unchanged), Verdict::Untold),
            (&[0.0; 4], false, None, Verdict::Exact),
            (&[1e-8; 4], true, None, Verdict::Exact),
            (
                &[0.4, 0.1, 0.0],
                true,
                Some(Untold::TooFew),
                Verdict::Untold,
            ),
            (&[0.4, 0.1, 0.025], true, None, Verdict::Holds),
            (&[0.4, 0.2, 0.1], false, None, Verdict::Below),
            (&[0.8, 0.1, 0.0125], false, None, Verdict::Higher),
        ] {
            let study = study(errors);
            assert_eq!(Untold::of(&study, is_next), untold, "{errors:?}");
            let found = Verdict::of(&study, untold, Some(2.0), 0.15);
            assert_eq!(found, verdict, "{errors:?}");
            assert_eq!(Verdict::of(&study, untold, None, 0.15), Verdict::Reported);
        }
    }
}
