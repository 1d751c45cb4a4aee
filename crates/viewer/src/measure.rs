//! Measuring the window itself: it orbits on its own, and says how fluent that was.

use std::time::{Duration, Instant};

use crate::viewer::Viewer;

/// What an orbit in the window cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Pictures that came.
    pub pictures: usize,
    /// Milliseconds between two pictures, rising.
    pub between_ms: Vec<f64>,
    /// Milliseconds of drawing each picture, rising.
    pub drawing_ms: Vec<f64>,
    /// Milliseconds of the interface's own work for each of its frames, rising: panels, layout and their shapes.
    pub interface_ms: Vec<f64>,
    /// Width and height of the pictures while moving.
    pub moving: [u32; 2],
}

impl Measured {
    /// The value at a share of the rising ones, 0 to 1.
    #[must_use]
    pub fn quantile(rising: &[f64], share: f64) -> f64 {
        let at = (rising.len().saturating_sub(1) as f64 * share.clamp(0.0, 1.0)).round();
        rising.get(at as usize).copied().unwrap_or(f64::NAN)
    }
}

/// A measurement that runs.
pub(crate) struct Measurement {
    length: Duration,
    /// When the first picture came.
    began: Option<Instant>,
    last: Option<(u64, Instant)>,
    measured: Measured,
}

impl Measurement {
    pub fn new(length: Duration) -> Self {
        Self {
            length,
            began: None,
            last: None,
            measured: Measured::default(),
        }
    }

    /// Takes note of a frame of the interface that took so long, and moves the camera on where a new picture has come.
    /// The result, when it is over.
    pub fn step(&mut self, viewer: &mut Viewer, interface: Duration) -> Option<Measured> {
        let (serial, size, drawing_ms) = {
            let told = viewer.worker().told();
            let size = told.shown.as_ref().map(|shown| shown.size);
            (told.serial, size, told.frame_ms)
        };
        let size = size?;
        let now = Instant::now();
        let began = *self.began.get_or_insert(now);
        self.measured
            .interface_ms
            .push(interface.as_secs_f64() * 1e3);
        let (last, since) = *self.last.get_or_insert((serial.wrapping_sub(1), now));
        if serial != last {
            // The first pictures are of the size that stands still.
            if self.measured.pictures > 3 {
                self.measured
                    .between_ms
                    .push((now - since).as_secs_f64() * 1e3);
                self.measured.drawing_ms.push(drawing_ms);
                self.measured.moving = size;
            }
            self.measured.pictures += 1;
            self.last = Some((serial, now));
            viewer.orbit(0.004, 0.0);
        }
        if now - began < self.length {
            return None;
        }
        let mut measured = std::mem::take(&mut self.measured);
        measured.between_ms.sort_by(f64::total_cmp);
        measured.drawing_ms.sort_by(f64::total_cmp);
        measured.interface_ms.sort_by(f64::total_cmp);
        Some(measured)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_were_measured() {
        let rising = [1.0, 2.0, 4.0];
        assert_eq!(Measured::quantile(&rising, 0.5), 2.0);
        assert_eq!(Measured::quantile(&rising, 1.0), 4.0);
        assert!(Measured::quantile(&[], 0.5).is_nan());
    }
}
