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

/// The points that no other beats in time and error, and by at least the factor `slack` (1 or more) in one of them: with
/// times that may be wrong by so much, any of them may be on the front.
#[must_use]
pub fn near_front(points: &[(f64, f64)], slack: f64) -> Vec<usize> {
    let front = front(points);
    let is_near = |(time, error): (f64, f64)| {
        front.iter().all(|at| {
            let (least_time, least_error) = points[*at];
            let is_beaten = least_time <= time && least_error <= error;
            let is_clear = least_time * slack <= time || least_error * slack <= error;
            !(is_beaten && is_clear) || (least_time, least_error) == (time, error)
        })
    };
    (0..points.len())
        .filter(|at| is_near(points[*at]))
        .collect()
}
