//! How coarsely a moving picture is drawn: as finely as its time allows, by the frames just drawn.
//!
//! A frame has a cost of its own beside that of its pixels, so the time of a size is not known from that of another one.
//! The first guess is by pixels; then the size goes one share finer or coarser by what its own frames take.

use std::time::Duration;

/// The shares of the full width: few, as each size has memory of its own made for it.
const SHARES: [f64; 7] = [1.0, 0.75, 0.5, 0.375, 0.25, 0.1875, 0.125];

/// Frames of a size before a finer one is tried.
const PATIENCE: u32 = 4;

/// What is known of the times of frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pace {
    /// Milliseconds of the last frame of the full size.
    full_ms: Option<f64>,
    /// The share that moving pictures have, as an index.
    level: Option<usize>,
    /// Smoothed milliseconds of its frames, and how many there were.
    smooth_ms: f64,
    frames: u32,
}

impl Pace {
    /// The share of the full width that fits the budget; 1 where nothing is known.
    pub fn share(&mut self, budget: Duration) -> f64 {
        let Some(full_ms) = self.full_ms else {
            return 1.0;
        };
        let budget = milliseconds(budget);
        let level = *self.level.get_or_insert_with(|| {
            let fits = |share: &f64| full_ms * share * share <= budget;
            SHARES.iter().position(fits).unwrap_or(SHARES.len() - 1)
        });
        SHARES[level]
    }

    /// Milliseconds that a frame of the full size took, or may be expected to.
    pub fn full_ms(&self) -> f64 {
        self.full_ms.unwrap_or(0.0)
    }

    /// Takes note of a frame that had a share of the full width.
    pub fn learn(&mut self, share: f64, ms: f64, budget: Duration) {
        if share >= 1.0 {
            self.full_ms = Some(ms);
        }
        let Some(level) = self.level.filter(|level| SHARES[*level] == share) else {
            return;
        };
        let budget = milliseconds(budget);
        self.smooth_ms = match self.frames {
            0 => ms,
            _ => 0.6 * self.smooth_ms + 0.4 * ms,
        };
        self.frames += 1;
        let coarser = match self.smooth_ms / budget {
            ratio if ratio > 3.0 => 2,
            ratio if ratio > 1.1 => 1,
            _ => 0,
        };
        let finer = level.checked_sub(1).is_some_and(|finer| {
            let growth = (SHARES[finer] / share).powi(2);
            self.frames >= PATIENCE && self.smooth_ms * growth < 0.9 * budget
        });
        let next = (level + coarser).min(SHARES.len() - 1) - usize::from(finer);
        if next != level {
            self.level = Some(next);
            self.frames = 0;
        }
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shares that a device with a fixed cost and one for a full picture settles between.
    fn settled(fixed_ms: f64, full_ms: f64, budget_ms: u64) -> Vec<f64> {
        let budget = Duration::from_millis(budget_ms);
        let mut pace = Pace::default();
        pace.learn(1.0, fixed_ms + full_ms, budget);
        let mut shares = Vec::new();
        for frame in 0..200 {
            let share = pace.share(budget);
            if frame > 100 {
                shares.push(share);
            }
            pace.learn(share, fixed_ms + full_ms * share * share, budget);
        }
        shares.dedup();
        shares
    }

    #[test]
    fn it_settles_at_the_finest_share_that_fits() {
        // Half the width takes 20 + 200 ms: too long; three eighths 20 + 112.5 ms.
        assert_eq!(settled(20.0, 800.0, 140), [0.375]);
        assert_eq!(settled(0.0, 30.0, 60), [1.0]);
        assert_eq!(settled(1.0, 1e5, 60), [0.125]);
    }

    #[test]
    fn a_slow_start_is_made_good() {
        let budget = Duration::from_millis(60);
        let mut pace = Pace::default();
        // The first frame built pipelines.
        pace.learn(1.0, 4000.0, budget);
        assert_eq!(pace.share(budget), 0.125);
        for _ in 0..60 {
            let share = pace.share(budget);
            pace.learn(share, 100.0 * share * share, budget);
        }
        assert_eq!(pace.share(budget), 0.5);
    }

    #[test]
    fn nothing_known_is_drawn_in_full() {
        assert_eq!(Pace::default().share(Duration::from_millis(1)), 1.0);
    }
}
