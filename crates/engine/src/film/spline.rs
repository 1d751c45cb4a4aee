//! Smooth ways through values at given times: Catmull-Rom splines for knots of any distances (Barry and Goldman 1988),
//! which are blends of blends of straight lines, so that the same holds for rotations, whose straight lines are arcs
//! (Schlag 1991).
//!
//! A way passes exactly through its values, its speed has no jumps, and two values are joined by a straight line. Before
//! the first value and after the last it stands still.

use glam::{DQuat, DVec3};

/// What can be blended.
pub(super) trait Blend: Copy {
    /// The place at `part` of the straight way from here to there; also before 0 and beyond 1.
    fn blend(self, there: Self, part: f64) -> Self;
}

impl Blend for f64 {
    fn blend(self, there: Self, part: f64) -> Self {
        self + part * (there - self)
    }
}

impl Blend for DVec3 {
    fn blend(self, there: Self, part: f64) -> Self {
        self + part * (there - self)
    }
}

impl Blend for DQuat {
    fn blend(self, there: Self, part: f64) -> Self {
        // The shorter of both arcs.
        let there = if self.dot(there) < 0.0 { -there } else { there };
        let arc = self.inverse() * there;
        (self * DQuat::from_scaled_axis(part * arc.to_scaled_axis())).normalize()
    }
}

/// The value at a time, of values at ascending times. There is at least one.
pub(super) fn at<T: Blend>(values: &[(f64, T)], time: f64) -> Option<T> {
    let (first, last) = (values.first()?, values.last()?);
    if time <= first.0 {
        return Some(first.1);
    }
    if time >= last.0 {
        return Some(last.1);
    }
    let next = values.partition_point(|(knot, _)| *knot <= time);
    let from = next.checked_sub(1)?;
    if values[from].0 == time {
        return Some(values[from].1);
    }
    // Between two values, on the line through them.
    let line = |a: usize| {
        let ((t0, v0), (t1, v1)) = (values[a], values[a + 1]);
        v0.blend(v1, (time - t0) / (t1 - t0))
    };
    // On the parabola through three.
    let arc = |a: usize| {
        let (t0, t2) = (values[a].0, values[a + 2].0);
        line(a).blend(line(a + 1), (time - t0) / (t2 - t0))
    };
    let (has_before, has_after) = (from > 0, next + 1 < values.len());
    Some(match (has_before, has_after) {
        (false, false) => line(from),
        (true, false) => arc(from - 1),
        (false, true) => arc(from),
        (true, true) => {
            let (t1, t2) = (values[from].0, values[next].0);
            arc(from - 1).blend(arc(from), (time - t1) / (t2 - t1))
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES: [f64; 5] = [0.0, 1.0, 4.0, 4.5, 7.0];

    #[test]
    fn parabolas_are_kept_at_uneven_times() {
        // What is a polynomial of order two is that spline itself.
        let parabola = |t: f64| 2.0 - 3.0 * t + 0.5 * t * t;
        let values = TIMES.map(|t| (t, parabola(t)));
        for step in 0..=70 {
            let t = 0.1 * f64::from(step);
            let is = at(&values, t).unwrap();
            assert!((is - parabola(t)).abs() < 1e-12, "{t}: {is}");
        }
        assert_eq!(at(&values, -1.0), Some(values[0].1));
        assert_eq!(at(&values, 9.0), Some(values[4].1));
        assert_eq!(at(&values[..1], 9.0), Some(values[0].1));
        assert_eq!(at::<f64>(&[], 0.0), None);
    }

    #[test]
    fn two_values_are_joined_by_a_line_and_an_arc() {
        let line = [(0.0, DVec3::ZERO), (4.0, DVec3::X)];
        assert_eq!(at(&line, 1.0), Some(0.25 * DVec3::X));
        let quarter = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
        // The other sign is the same rotation.
        for end in [quarter, -quarter] {
            let half = at(&[(0.0, DQuat::IDENTITY), (2.0, end)], 1.0).unwrap();
            let wanted = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_4);
            assert!(half.angle_between(wanted) < 1e-7, "{half}");
        }
    }

    #[test]
    fn rotations_pass_through_their_keys_without_jumps_of_speed() {
        let turn = |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians());
        let keys = [
            DQuat::IDENTITY,
            turn(DVec3::Z, 60.0),
            turn(DVec3::X, 80.0),
            -turn(DVec3::Y, 30.0),
            turn(DVec3::Z, -100.0),
        ];
        let values: Vec<(f64, DQuat)> = TIMES.into_iter().zip(keys).collect();
        for (time, key) in &values {
            assert_eq!(at(&values, *time), Some(*key));
        }
        let step = 1e-5;
        let speed = |from: f64| {
            let [a, b] = [from, from + step].map(|t| at(&values, t).unwrap());
            (a.inverse() * if a.dot(b) < 0.0 { -b } else { b }).to_scaled_axis() / step
        };
        for time in &TIMES[1..4] {
            let jump = (speed(time - step) - speed(*time)).length();
            assert!(jump < 1e-3, "{time}: {jump}");
        }
    }

    #[test]
    fn rotations_about_one_axis_go_as_their_angles_do() {
        let angles = [0.0, 0.4, 1.1, 1.3, 0.2];
        let turns: Vec<(f64, DQuat)> = TIMES
            .into_iter()
            .zip(angles.map(DQuat::from_rotation_z))
            .collect();
        let numbers: Vec<(f64, f64)> = TIMES.into_iter().zip(angles).collect();
        for step in 0..=70 {
            let t = 0.1 * f64::from(step);
            let wanted = DQuat::from_rotation_z(at(&numbers, t).unwrap());
            let is = at(&turns, t).unwrap();
            assert!(is.dot(wanted).abs() > 1.0 - 1e-12, "{t}");
        }
    }
}
