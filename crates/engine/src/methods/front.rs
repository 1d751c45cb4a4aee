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
/// times that may be wrong by so much, any of them may be on the front. The nearest to the front come first; of equally
/// near ones the first.
#[must_use]
pub fn near_front(points: &[(f64, f64)], slack: f64) -> Vec<usize> {
    let front: Vec<(f64, f64)> = front(points).into_iter().map(|at| points[at]).collect();
    let distances = points.iter().map(|point| distance(*point, &front));
    let mut near: Vec<(usize, f64)> = distances.enumerate().collect();
    near.retain(|(_, distance)| *distance == 1.0 || *distance < slack);
    near.sort_by(|a, b| a.1.total_cmp(&b.1));
    near.into_iter().map(|(at, _)| at).collect()
}

/// The largest factor, in time or in error, by which a point of the front beats this one in both; 1 where none does.
fn distance((time, error): (f64, f64), front: &[(f64, f64)]) -> f64 {
    let factor = |value: f64, least: f64| if value > least { value / least } else { 1.0 };
    let beating = front
        .iter()
        .filter(|(least_time, least_error)| *least_time <= time && *least_error <= error);
    beating
        .map(|(least_time, least_error)| factor(time, *least_time).max(factor(error, *least_error)))
        .fold(1.0, f64::max)
}
