//! Which of many (time, error) pairs are worth having.

/// The Pareto front: the indices of the points that no other equals or beats in both time and error and beats in one,
/// by rising time. Of equal points the first stays.
#[must_use]
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| {
        let ((time_a, error_a), (time_b, error_b)) = (points[*a], points[*b]);
        time_a.total_cmp(&time_b).then(error_a.total_cmp(&error_b))
    });
    let mut least = f64::INFINITY;
    order.retain(|at| {
        let is_better = points[*at].1 < least;
        least = least.min(points[*at].1);
        is_better
    });
    order
}

/// The points that no other beats by more than the factor `slack` (at least 1) in both time and error: with times that
/// may be wrong by so much, any of them may be on the front.
#[must_use]
pub fn near_front(points: &[(f64, f64)], slack: f64) -> Vec<usize> {
    let front = front(points);
    (0..points.len())
        .filter(|at| {
            let (time, error) = points[*at];
            front
                .iter()
                .all(|other| points[*other].0 * slack > time || points[*other].1 * slack > error)
                || front.contains(at)
        })
        .collect()
}
