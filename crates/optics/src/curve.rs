//! Piecewise linear curves with steps.

/// Control points in an order of positions that never decreases; at least one. Two points at one position are a
/// step, and at the step itself the later one holds. Before the first and behind the last point their values hold.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve<const N: usize> {
    points: Vec<(f64, [f64; N])>,
}

impl<const N: usize> Curve<N> {
    /// `points` are finite, in order, and at least one; the reader has seen to it.
    pub(crate) fn new(points: Vec<(f64, [f64; N])>) -> Self {
        debug_assert!(!points.is_empty() && points.is_sorted_by(|a, b| a.0 <= b.0));
        Self { points }
    }

    pub(crate) fn points(&self) -> &[(f64, [f64; N])] {
        &self.points
    }

    /// The positions of its points; a constant has none.
    pub(crate) fn knots(&self) -> Vec<f64> {
        match self.points.as_slice() {
            [_] => Vec::new(),
            points => points.iter().map(|(at, _)| *at).collect(),
        }
    }

    pub(crate) fn at(&self, s: f64) -> [f64; N] {
        self.ends(s, s, s).0
    }

    /// What it comes to from below `s`: at a step the earlier value, elsewhere that of [`at`](Self::at).
    pub(crate) fn before(&self, s: f64) -> [f64; N] {
        let next = self.points.partition_point(|(at, _)| *at < s);
        match self.points.get(next) {
            Some((at, value)) if *at == s || next == 0 => *value,
            _ => self.at(s),
        }
    }

    /// The values at `from` and `to` of the linear piece that the open interval between them lies in, so that a
    /// step at either end does not show.
    pub(crate) fn over(&self, from: f64, to: f64) -> ([f64; N], [f64; N]) {
        self.ends(from + 0.5 * (to - from), from, to)
    }

    fn ends(&self, inside: f64, from: f64, to: f64) -> ([f64; N], [f64; N]) {
        let next = self.points.partition_point(|(at, _)| *at <= inside);
        let before = &self.points[next.saturating_sub(1)];
        let after = self.points.get(next).unwrap_or(before);
        let value = |s: f64| {
            if next == 0 || before.0 >= after.0 {
                return before.1;
            }
            let t = ((s - before.0) / (after.0 - before.0)).clamp(0.0, 1.0);
            std::array::from_fn(|i| before.1[i] + t * (after.1[i] - before.1[i]))
        };
        (value(from), value(to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_takes_the_later_value_and_ends_hold() {
        let curve = Curve::new(vec![
            (0.0, [1.0]),
            (1.0, [3.0]),
            (1.0, [7.0]),
            (2.0, [7.0]),
            (3.0, [0.0]),
        ]);
        for (s, value) in [
            (-1.0, 1.0),
            (0.0, 1.0),
            (0.5, 2.0),
            (1.0, 7.0),
            (2.5, 3.5),
            (3.0, 0.0),
            (9.0, 0.0),
        ] {
            assert_eq!(curve.at(s), [value], "at {s}");
            let before = if s == 1.0 { 3.0 } else { value };
            assert_eq!(curve.before(s), [before], "before {s}");
        }
        assert_eq!(curve.over(0.5, 1.0), ([2.0], [3.0]));
        assert_eq!(curve.over(1.0, 2.0), ([7.0], [7.0]));
        assert_eq!(curve.over(-2.0, -1.0), ([1.0], [1.0]));
    }

    #[test]
    fn a_step_at_the_very_start_shows_its_first_value_before_it() {
        let curve = Curve::new(vec![(0.0, [1.0]), (0.0, [2.0])]);
        assert_eq!(
            (curve.at(-1e-9), curve.at(0.0), curve.at(1.0)),
            ([1.0], [2.0], [2.0])
        );
    }
}
