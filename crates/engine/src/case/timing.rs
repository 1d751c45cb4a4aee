//! Times of frames: two settings in turn, so that what else the machine does falls on both.

use volgraph_measure::timing::ratio;
use volgraph_report::Findings;

use super::measure::incomparable;
use super::outcome::Measured;
use super::run::Run;
use super::{Other, Point};
use crate::Session;
use crate::methods::{middle, timed_frame, turned};

/// Frames of each before those that count.
const WARM_UP: u32 = 2;

impl Run<'_> {
    /// The median of the ratios of frames that were drawn in turn, reading back included.
    pub(super) fn not_slower(
        &mut self,
        point: &Point,
        than: &Other,
        bound: f64,
        frames: u32,
    ) -> Result<Measured, Findings> {
        let own = self.renderer.own(point, &[])?;
        let other = self.renderer.other(point, than)?;
        let (mut a, _) = self.renderer.session(&own)?;
        let (mut b, _) = self.renderer.session(&other)?;
        let (mut times_a, mut times_b) = (Vec::new(), Vec::new());
        for frame in 0..WARM_UP + frames {
            // Who is first changes, so that what being first costs falls on both.
            let (time_a, time_b) = if frame % 2 == 0 {
                let time_a = frame_ms(&mut a)?;
                (time_a, frame_ms(&mut b)?)
            } else {
                let time_b = frame_ms(&mut b)?;
                (frame_ms(&mut a)?, time_b)
            };
            if frame >= WARM_UP {
                times_a.push(time_a);
                times_b.push(time_b);
            }
        }
        Ok(match ratio(&times_a, &times_b) {
            Err(error) => incomparable(&error),
            Ok(ratio) => {
                let detail = format!(
                    "takes {:.2} times as long ({:.2} to {:.2} in {} pairs), at most {bound}; {:.2} ms at best for {:.2} ms",
                    ratio.median,
                    ratio.min,
                    ratio.max,
                    ratio.n,
                    least(&times_a),
                    least(&times_b),
                );
                Measured::new(ratio.median <= bound, Some((ratio.median, bound)), detail)
            }
        })
    }
}

fn least(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

fn frame_ms(session: &mut Session) -> Result<f64, Findings> {
    // A frame from the same place would be remembered, and not drawn: each is a degree farther on.
    let (camera, target) = (session.view().camera, middle(session.plan()));
    Ok(timed_frame(session, turned(&camera, target, 1.0), true)?.0)
}
