//! Times of frames: two settings in turn, so that what else the machine does falls on both.

use std::time::Instant;

use glam::{DQuat, DVec3};
use volgraph_measure::timing::ratio;
use volgraph_report::Findings;

use super::measure::incomparable;
use super::outcome::Measured;
use super::run::Run;
use super::{Other, Point};
use crate::{Camera, Session};

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
            // A frame from the same place would be remembered, and not drawn.
            let degrees = f64::from(frame);
            let (time_a, time_b) = (frame_ms(&mut a, degrees)?, frame_ms(&mut b, degrees)?);
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

fn frame_ms(session: &mut Session, degrees: f64) -> Result<f64, Findings> {
    let camera = turned(session, degrees.min(1.0));
    session.place_camera(camera);
    let start = Instant::now();
    session.draw()?;
    session.read("color")?;
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

/// The camera a little farther around the middle of what is drawn.
fn turned(session: &Session, degrees: f64) -> Camera {
    let corners = session.plan().corners();
    let middle = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
    let mut camera = session.view().camera;
    let turn = DQuat::from_axis_angle(camera.up, degrees.to_radians());
    camera.eye = middle + turn * (camera.eye - middle);
    camera.right = turn * camera.right;
    camera.forward = turn * camera.forward;
    camera
}
