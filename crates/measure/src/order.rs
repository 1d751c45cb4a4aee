//! The order of convergence: how fast an error falls with the step (Etiene et al. 2014).

/// The order `p` of errors that go like `step^p`: the slope of the line that fits the logarithms of both best. `None` for
/// fewer than two pairs, steps that are all one, or a step or error that is not above 0.
#[must_use]
pub fn order(steps: &[f64], errors: &[f64]) -> Option<f64> {
    let is_whole = steps.len() == errors.len() && steps.len() >= 2;
    let are_positive = steps
        .iter()
        .chain(errors)
        .all(|value| value.is_finite() && *value > 0.0);
    if !is_whole || !are_positive {
        return None;
    }
    let n = steps.len() as f64;
    let logarithms =
        |values: &[f64]| -> Vec<f64> { values.iter().map(|value| value.ln()).collect() };
    let (x, y) = (logarithms(steps), logarithms(errors));
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let (mean_x, mean_y) = (mean(&x), mean(&y));
    let across: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let along: f64 = x
        .iter()
        .zip(&y)
        .map(|(x, y)| (x - mean_x) * (y - mean_y))
        .sum();
    (across > 0.0).then(|| along / across)
}

#[cfg(test)]
mod tests {
    use super::order;

    #[test]
    fn powers_have_their_exponents_and_nonsense_has_none() {
        let steps = [1.0, 0.5, 0.25, 0.1];
        for exponent in [0.0, 1.0, 2.0, 3.5] {
            let errors = steps.map(|step: f64| 7.0 * step.powf(exponent));
            assert!((order(&steps, &errors).unwrap() - exponent).abs() < 1e-12);
        }
        assert_eq!(order(&[1.0], &[1.0]), None);
        assert_eq!(order(&[1.0, 1.0], &[1.0, 2.0]), None);
        assert_eq!(order(&[1.0, 0.5], &[1.0, 0.0]), None);
        assert_eq!(order(&[1.0, 0.5], &[1.0, f64::NAN]), None);
        assert_eq!(order(&[1.0, 0.5], &[1.0]), None);
    }
}
