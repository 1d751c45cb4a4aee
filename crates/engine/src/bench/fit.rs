//! By which power a cost grows: a straight line through the logarithms.

use serde::Serialize;

/// `cost = factor · work ^ exponent`, fitted by least squares to the logarithms of both.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PowerFit {
    /// The slope of the logarithms.
    pub exponent: f64,
    /// Its standard error from how far the points are off the line; `None` of two points, which are always on it.
    pub standard_error: Option<f64>,
    /// The cost of one unit of work.
    pub factor: f64,
    /// The least work of the points.
    pub from: f64,
    /// The most.
    pub to: f64,
    /// How many points there are.
    pub points: usize,
}

impl PowerFit {
    /// The cost of a work.
    #[must_use]
    pub fn at(&self, work: f64) -> f64 {
        self.factor * work.powf(self.exponent)
    }
}

/// Fits a power to (work, cost); nothing is subtracted from either. `None` where there are not two different works above 0
/// with costs above 0.
#[must_use]
pub fn fit(points: &[(f64, f64)]) -> Option<PowerFit> {
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    let usable = points
        .iter()
        .filter(|(work, cost)| is_positive(*work) && is_positive(*cost));
    let logs: Vec<(f64, f64)> = usable.map(|(work, cost)| (work.ln(), cost.ln())).collect();
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|log| log.0).sum::<f64>() / n;
    let mean_y = logs.iter().map(|log| log.1).sum::<f64>() / n;
    let spread: f64 = logs.iter().map(|log| (log.0 - mean_x).powi(2)).sum();
    if logs.len() < 2 || spread <= 1e-12 {
        return None;
    }
    let together: f64 = logs
        .iter()
        .map(|log| (log.0 - mean_x) * (log.1 - mean_y))
        .sum();
    let exponent = together / spread;
    let offset = mean_y - exponent * mean_x;
    let squares: f64 = logs
        .iter()
        .map(|log| (log.1 - offset - exponent * log.0).powi(2))
        .sum();
    let standard_error = (logs.len() > 2).then(|| (squares / (n - 2.0) / spread).sqrt());
    let works = || logs.iter().map(|log| log.0);
    Some(PowerFit {
        exponent,
        standard_error,
        factor: offset.exp(),
        from: works().fold(f64::INFINITY, f64::min).exp(),
        to: works().fold(f64::NEG_INFINITY, f64::max).exp(),
        points: logs.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_found_with_its_error() {
        let exact: Vec<(f64, f64)> = [1.0, 2.0, 4.0, 8.0]
            .map(|work: f64| (work, 3.0 * work.powf(1.5)))
            .into();
        let found = fit(&exact).unwrap();
        assert!((found.exponent - 1.5).abs() < 1e-12 && (found.factor - 3.0).abs() < 1e-12);
        assert!(found.standard_error.unwrap() < 1e-12);
        assert!((found.at(16.0) - 3.0 * 64.0).abs() < 1e-9);
        assert_eq!(found.points, 4);
        // Three points at logarithms 0, 1, 2 with costs 0, 1 + d, 2: the slope stays 1, and the residuals are -d/3, 2d/3,
        // -d/3; so the error is sqrt(6 d²/9 / 1 / 2).
        let d = 0.3_f64;
        let off = [
            (1.0, 1.0),
            (1.0_f64.exp(), (1.0 + d).exp()),
            (2.0_f64.exp(), 2.0_f64.exp()),
        ];
        let found = fit(&off).unwrap();
        assert!((found.exponent - 1.0).abs() < 1e-12);
        assert!((found.standard_error.unwrap() - (6.0 * d * d / 9.0 / 2.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_line_is_not_fitted() {
        assert_eq!(fit(&[]), None);
        assert_eq!(fit(&[(2.0, 1.0)]), None);
        assert_eq!(fit(&[(2.0, 1.0), (2.0, 3.0)]), None);
        // What is not above 0 has no logarithm.
        assert_eq!(
            fit(&[(2.0, 1.0), (4.0, 0.0), (0.0, 1.0), (8.0, f64::NAN)]),
            None
        );
        assert_eq!(fit(&[(1.0, 1.0), (2.0, 2.0)]).unwrap().standard_error, None);
    }
}
