//! The camera's way once around what is drawn.

use serde::Serialize;

use crate::methods::LEAST_TURN_DEGREES;

/// Views all around, evenly spread. They are visited in an order of which every beginning is spread as well, so that a
/// rotation which is cut short is still one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rotation {
    /// Degrees between neighbours.
    pub turn_degrees: f64,
    /// Degrees of each view, in the order in which they are drawn.
    pub degrees: Vec<f64>,
}

impl Rotation {
    /// Once around by this turn, of at least [`LEAST_TURN_DEGREES`], which is rounded so that a whole number of views goes
    /// around; by a longer one where that were more than `most` views. At least one view.
    #[must_use]
    pub fn new(turn_degrees: f64, most: u32) -> Self {
        let wanted = (360.0 / turn_degrees.abs().max(LEAST_TURN_DEGREES)).round();
        let views = if wanted >= 1.0 {
            wanted.min(f64::from(most.max(1)))
        } else {
            1.0
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 1 to a number of 32 bits"
        )]
        let count = views as u32;
        let turn_degrees = 360.0 / views;
        // Numbers with their bits reversed are spread, however many of them there are.
        let bits = count.next_power_of_two().trailing_zeros();
        let reversed = (0..1_u64 << bits).map(|number| {
            if bits == 0 {
                0
            } else {
                number.reverse_bits() >> (64 - bits)
            }
        });
        let degrees = reversed
            .filter(|number| *number < u64::from(count))
            .map(|number| number as f64 * turn_degrees);
        Self {
            turn_degrees,
            degrees: degrees.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_has_every_view_once_and_any_beginning_of_it_is_spread() {
        let whole = Rotation::new(2.0, 1000);
        assert_eq!((whole.turn_degrees, whole.degrees.len()), (2.0, 180));
        let mut sorted = whole.degrees.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(
            sorted
                .iter()
                .enumerate()
                .all(|(at, degrees)| *degrees == 2.0 * at as f64)
        );
        // No gap of the first eight is half of the way around.
        let mut first = whole.degrees[..8].to_vec();
        first.sort_by(f64::total_cmp);
        let gaps = first.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(
            gaps.fold(360.0 - first[7] + first[0], f64::max) < 120.0,
            "{first:?}"
        );
        assert_eq!(Rotation::new(2.0, 9).degrees.len(), 9);
        assert_eq!(Rotation::new(2.0, 1).degrees, [0.0]);
        assert_eq!(Rotation::new(-7.0, 1000).degrees.len(), 51);
        assert_eq!(Rotation::new(720.0, 5).degrees, [0.0]);
        assert_eq!(Rotation::new(1e-9, u32::MAX).degrees.len(), 360_000);
    }
}
