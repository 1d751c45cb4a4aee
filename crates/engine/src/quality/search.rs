//! What a budget is searched with: arithmetic alone, so that it is tested without a picture.
//!
//! Steps are 2^(rung / 4) voxels. [`longest`] takes the error to fall with the step: from where it starts it goes up or
//! down by octaves until the bound lies in between, and then halves what is left. A method whose error no longer falls
//! (a floor: early termination, tables, storage) is given up, not followed to the finest step. [`best`] is the fastest
//! inside an error budget, or the most accurate inside a time; where none is inside, the nearest. [`shortened`] makes of a
//! step one that keeps the error elsewhere as well.

use volgraph_graph::Budget;

const RUNGS_TO_AN_OCTAVE: i32 = 4;

/// A sixteenth of a voxel, and 16 voxels.
const FINEST: i32 = -16;
pub(super) const COARSEST: i32 = 16;

/// Below half a voxel an octave has to make the error at least so many times less.
const LEAST_GAIN: f64 = 1.3;
const GAIN_IS_ASKED_BELOW: i32 = -RUNGS_TO_AN_OCTAVE;

/// The step of a rung, in voxels.
pub(super) fn step(rung: i32) -> f64 {
    (f64::from(rung) / f64::from(RUNGS_TO_AN_OCTAVE)).exp2()
}

/// The finest rung whose step is no shorter than this one.
pub(super) fn finest_rung(shortest: f64) -> i32 {
    let mut rung = FINEST;
    while rung < COARSEST && step(rung) < shortest {
        rung += 1;
    }
    rung
}

/// The rung nearest to a step.
pub(super) fn rung(step: f64) -> i32 {
    let rung = step.log2() * f64::from(RUNGS_TO_AN_OCTAVE);
    #[expect(clippy::cast_possible_truncation, reason = "between two small numbers")]
    let nearest = rung.clamp(f64::from(FINEST), f64::from(COARSEST)).round() as i32;
    nearest
}

/// Where a search ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub rung: i32,
    pub rmse: f64,
}

/// The longest step whose error is at most `most`, no finer than `finest`; the finest that was tried where none is.
pub(super) fn longest<E>(
    start: i32,
    finest: i32,
    most: f64,
    mut error: impl FnMut(i32) -> Result<f64, E>,
) -> Result<Found, E> {
    let finest = finest.clamp(FINEST, COARSEST);
    let mut rung = start.clamp(finest, COARSEST);
    // The longest step known to be inside, and the shortest known to be outside.
    let (mut inside, mut outside): (Option<Found>, Option<Found>) = (None, None);
    loop {
        let found = Found {
            rung,
            rmse: error(rung)?,
        };
        let before = outside;
        if found.rmse <= most {
            inside = Some(found);
        } else {
            outside = Some(found);
        }
        let next = match (inside, outside) {
            (Some(low), Some(high)) => low.rung + (high.rung - low.rung) / 2,
            (Some(low), None) => (low.rung + RUNGS_TO_AN_OCTAVE).min(COARSEST),
            (None, Some(high)) => {
                let is_stuck = before.is_some_and(|before| {
                    high.rung < GAIN_IS_ASKED_BELOW && before.rmse < LEAST_GAIN * high.rmse
                });
                if is_stuck {
                    return Ok(high);
                }
                (high.rung - RUNGS_TO_AN_OCTAVE).max(finest)
            }
            (None, None) => rung,
        };
        let is_known = |known: Option<Found>| known.is_some_and(|known| known.rung == next);
        if is_known(inside) || is_known(outside) {
            return Ok(inside.unwrap_or(found));
        }
        rung = next;
    }
}

/// A step and its error: the first of shorter and shorter ones whose error is at most `most`, as long as an octave makes
/// it less, and no step is below `finest`; else the last that was tried. Of `most` the share `share` is aimed at.
pub(super) fn shortened<E>(
    start: f64,
    finest: f64,
    most: f64,
    share: f64,
    mut error: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(f64, f64), E> {
    let (mut step, mut before) = (start, f64::INFINITY);
    loop {
        let rmse = error(step)?;
        let helps = rmse * LEAST_GAIN <= before;
        // An octave at least, as `LEAST_GAIN` is of one.
        let next = (step * (share * most / rmse).min(0.5)).max(finest);
        if rmse <= most || !helps || next >= step {
            return Ok((step, rmse));
        }
        (before, step) = (rmse, next);
    }
}

/// The step, between the finest and the coarsest, with which a frame should take `most` milliseconds, from two that were
/// timed: a frame takes a constant, and a share for each segment.
pub(super) fn step_in_time(fine: (f64, f64), coarse: (f64, f64), most: f64, finest: f64) -> f64 {
    let share = (fine.1 - coarse.1) / (fine.0.recip() - coarse.0.recip());
    let rest = fine.1 - share / fine.0;
    let ideal = if most <= rest {
        f64::INFINITY
    } else if share > 0.0 {
        share / (most - rest)
    } else {
        0.0
    };
    ideal.max(finest).min(step(COARSEST))
}

/// What is known of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Figures {
    pub rmse: f64,
    pub ms: f64,
}

/// Which of these a budget takes, of whose error only the share `share` is given away.
pub(super) fn best(figures: &[Figures], budget: Budget, share: f64) -> Option<usize> {
    // What is limited, and what is then made as good as it can be.
    let place = |it: &Figures| {
        let (limited, most, cost) = match budget {
            Budget::Rmse(rmse) => (it.rmse, share * rmse, it.ms),
            Budget::TimeMs(ms) => (it.ms, ms, it.rmse),
        };
        let is_outside = limited > most;
        (is_outside, if is_outside { limited } else { cost })
    };
    let numbered = figures.iter().map(place).enumerate();
    let nearest = numbered.min_by(|(_, a), (_, b)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    nearest.map(|(at, _)| at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(start: i32, finest: i32, most: f64, law: impl Fn(f64) -> f64) -> (Found, Vec<i32>) {
        let mut tried = Vec::new();
        let found = longest(start, finest, most, |rung| {
            tried.push(rung);
            Ok::<_, ()>(law(step(rung)))
        });
        (found.unwrap(), tried)
    }

    #[test]
    fn the_longest_step_is_found_from_everywhere() {
        for start in [FINEST, -3, 0, 5, COARSEST] {
            for most in [1e-4, 1e-3, 0.01, 0.1, 1.0] {
                let (found, tried) = search(start, FINEST, most, |step| 0.01 * step * step);
                // The error at step s is 0.01 s², so s = 10 √most.
                let ideal = 10.0 * most.sqrt();
                assert!(found.rmse <= most, "{start} {most}: {found:?}");
                let next = step(found.rung + 1);
                assert!(
                    found.rung == COARSEST || next > ideal,
                    "{start} {most}: {found:?}"
                );
                assert!(tried.len() <= 12, "{start} {most}: {tried:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_reached_ends_at_the_finest_and_a_floor_ends_it_sooner() {
        let (found, tried) = search(0, FINEST, 1e-9, |step| step);
        assert_eq!(found.rung, FINEST);
        assert_eq!(tried, [0, -4, -8, -12, -16]);
        let (found, tried) = search(0, -8, 1e-9, |step| step);
        assert_eq!((found.rung, tried.len()), (-8, 3));
        let (found, tried) = search(0, FINEST, 1e-9, |step| 0.1 + 1e-3 * step);
        assert_eq!(found.rung, -8);
        assert_eq!(tried, [0, -4, -8]);
        // Errors that jump about end it all the same.
        let (found, _) = search(0, FINEST, 0.5, |step| (37.0 * step).sin().abs());
        assert!(found.rmse <= 0.5, "{found:?}");
    }

    #[test]
    fn errors_of_the_search_are_passed_on() {
        assert_eq!(longest(0, FINEST, 1.0, |_| Err("lost")), Err("lost"));
    }

    #[test]
    fn steps_follow_from_two_times() {
        // 10 ms and 40 ms for each segment in a voxel.
        let ms = |step: f64| 10.0 + 40.0 / step;
        let finest = step(FINEST);
        let in_time = |most| step_in_time((1.0, ms(1.0)), (4.0, ms(4.0)), most, finest);
        assert!((in_time(30.0) - 2.0).abs() < 1e-12);
        assert!((in_time(90.0) - 0.5).abs() < 1e-12);
        assert_eq!(in_time(9.0), step(COARSEST));
        assert_eq!(in_time(1e9), finest);
        // Noise: the longer step took longer.
        assert_eq!(step_in_time((1.0, 20.0), (4.0, 21.0), 50.0, 0.5), 0.5);
    }

    #[test]
    fn a_step_gets_shorter_as_long_as_that_helps() {
        let shorten = |most: f64, finest: f64, law: fn(f64) -> f64| {
            let mut tried = Vec::new();
            let found = shortened(1.0, finest, most, 0.8, |step| {
                tried.push(step);
                Ok::<_, ()>(law(step))
            });
            (found.unwrap(), tried)
        };
        // What is inside stays; a little outside costs an octave, and much as many as it takes.
        assert_eq!(
            shorten(0.02, 0.0, |step| 0.01 * step),
            ((1.0, 0.01), vec![1.0])
        );
        assert_eq!(shorten(0.009, 0.0, |step| 0.01 * step).1, [1.0, 0.5]);
        let ((step, rmse), tried) = shorten(1e-4, 0.0, |step| 0.01 * step);
        assert!(
            rmse <= 1e-4 && step > 0.005 && tried.len() <= 3,
            "{tried:?}"
        );
        // A floor, and the shortest step that there is.
        let ((step, rmse), tried) = shorten(1e-4, 0.0, |step| 3e-3 + 8e-4 * step);
        assert!(rmse > 3e-3 && step < 1.0 && tried.len() == 2, "{tried:?}");
        let ((step, _), _) = shorten(1e-4, 0.25, |step| 0.01 * step);
        assert_eq!(step, 0.25);
        assert_eq!(shortened(1.0, 0.1, 1.0, 0.8, |_| Err("lost")), Err("lost"));
    }

    #[test]
    fn the_finest_rung_is_no_shorter_than_a_ray_allows() {
        assert_eq!(finest_rung(0.0), FINEST);
        assert_eq!(finest_rung(0.5), -4);
        assert_eq!(finest_rung(0.51), -3);
        assert_eq!(finest_rung(1e9), COARSEST);
    }

    #[test]
    fn rungs_and_steps_are_each_others() {
        for at in FINEST..=COARSEST {
            assert_eq!(rung(step(at)), at);
        }
        assert_eq!((rung(0.0), rung(1e9)), (FINEST, COARSEST));
    }

    #[test]
    fn the_best_is_inside_and_cheap_or_nearest() {
        let figures = |pairs: &[(f64, f64)]| -> Vec<Figures> {
            let pairs = pairs.iter();
            pairs.map(|&(rmse, ms)| Figures { rmse, ms }).collect()
        };
        let found = figures(&[(0.0009, 5.0), (0.0001, 9.0), (0.0005, 7.0)]);
        assert_eq!(best(&found, Budget::Rmse(0.001), 0.8), Some(2));
        assert_eq!(best(&found, Budget::Rmse(0.00001), 0.8), Some(1));
        assert_eq!(best(&found, Budget::TimeMs(8.0), 0.8), Some(2));
        assert_eq!(best(&found, Budget::TimeMs(1.0), 0.8), Some(0));
        assert_eq!(best(&[], Budget::TimeMs(1.0), 0.8), None);
    }
}
