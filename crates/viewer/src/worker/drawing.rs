//! Frames: of changes, of a camera that moves, of one that stands still.

use std::sync::Arc;
use std::time::{Duration, Instant};

use volgraph_engine::{
    Change, Findings, FrameReport, Gpu, LOOK, Outcome, ParamOverride, Refused, Session,
};

use super::{Note, Work, told};
use crate::looked::Looked;

/// How long the camera stands still before the picture is refined.
const STILL: Duration = Duration::from_millis(200);

impl Work {
    /// Applies a change; what is refused leaves the picture as it is, and is told.
    pub(super) fn apply(&mut self, change: &Change, keeps_picture: bool) {
        if self.session.is_none() {
            let graph = self.options.graph.clone();
            return self.open(graph);
        }
        self.tell(|told| told.is_busy = true);
        let start = Instant::now();
        let Some(session) = &mut self.session else {
            return;
        };
        let progress = told::Progress(Arc::clone(&self.told), Arc::clone(&self.wake));
        let applied = session.apply_with(change, &progress);
        let dependencies = session.dependencies().clone();
        self.drawn_size = session.view().size;
        self.arm_with(dependencies);
        if matches!(change, Change::Files(_)) {
            let refused = applied.as_ref().err();
            self.wrong = refused.map_or_else(Findings::new, |refused| refused.findings.clone());
        }
        match applied {
            Ok(Outcome::Unchanged) => self.show(Findings::new()),
            Ok(Outcome::Drawn(drawn)) => {
                let total = start.elapsed();
                self.learn(drawn.report.stages.draw_ms);
                let is_whole = self.drawn_size == self.full;
                self.is_kept_later |= keeps_picture;
                // Of bricks that are still to come, a picture is not kept for comparisons.
                let is_done = is_whole && drawn.report.frame.progress.is_whole();
                let keeps_now = is_done && std::mem::take(&mut self.is_kept_later);
                if !is_whole {
                    self.moved = Some(Instant::now());
                }
                let warnings = self.expect_more(&drawn.report.frame);
                self.tell(|told| {
                    told.frame = Some(drawn.report.frame.clone());
                    if keeps_picture {
                        told.note(Note::of(change, &drawn.report, total));
                        told.report = Some(drawn.report);
                    }
                    if keeps_now {
                        told.keep(drawn.picture);
                    } else if is_whole {
                        told.refined = Some(Arc::new(drawn.picture));
                    }
                });
                self.show(warnings);
            }
            Err(refused) => self.refuse(refused),
        }
    }

    /// Sets values as they are dragged: coarsely where a whole picture takes long, which comes when they stay.
    pub(super) fn set(&mut self, sets: Vec<ParamOverride>) {
        self.be_coarse();
        self.apply(&Change::Set(sets), true);
    }

    /// Makes what comes next as coarse as the time for a frame needs.
    pub(super) fn be_coarse(&mut self) {
        let size = self.coarse();
        let is_whole = self
            .session
            .as_ref()
            .is_some_and(|session| session.view().size == self.full);
        if is_whole && 2.0 * pixels(size) < pixels(self.full) {
            self.apply(&Change::Size(size), false);
        }
    }

    fn refuse(&mut self, refused: Refused) {
        let Refused {
            findings,
            device_remade,
            ..
        } = refused;
        if let Some(reason) = device_remade {
            self.tell(|told| told.note(Note::new(format!("device opened again: {reason}"))));
        }
        self.show(findings);
    }

    /// Moves the camera and draws as finely as the time allows.
    pub(super) fn move_to(&mut self, stand: impl FnOnce(&mut Session)) {
        let Some(session) = &mut self.session else {
            return;
        };
        stand(session);
        self.moved = Some(Instant::now());
        let size = self.coarse();
        self.draw_at(size);
    }

    /// The size for which a frame fits the budget.
    fn coarse(&mut self) -> [u32; 2] {
        scaled(self.full, self.pace.share(self.budget))
    }

    fn draw_at(&mut self, size: [u32; 2]) {
        let Some(session) = &mut self.session else {
            return;
        };
        if size != session.view().size {
            return self.apply(&Change::Size(size), false);
        }
        let start = Instant::now();
        let drawn = session.draw();
        self.drawn_size = size;
        match drawn {
            Ok(frame) => {
                self.learn(start.elapsed().as_secs_f64() * 1e3);
                let warnings = frame.warnings.clone();
                self.tell(|told| told.frame = Some(frame));
                self.show(warnings);
            }
            Err(findings) => self.show(findings),
        }
    }

    /// Takes note of what a frame of the last size took. Frames of which nothing had to be drawn teach nothing.
    fn learn(&mut self, milliseconds: f64) {
        if milliseconds < 0.05 {
            return;
        }
        let share = self.pace.share(self.budget);
        if self.drawn_size == self.full {
            self.pace.learn(1.0, milliseconds, self.budget);
        } else if self.drawn_size == scaled(self.full, share) {
            self.pace.learn(share, milliseconds, self.budget);
        }
        self.tell(|told| told.frame_ms = milliseconds);
    }

    /// Draws the picture of a still camera, in two steps where that takes long.
    pub(super) fn refine(&mut self) {
        let is_due = |moved: Instant| moved.elapsed() >= STILL;
        if !self.moved.is_some_and(is_due) {
            return;
        }
        let budget = self.budget.as_secs_f64() * 1e3;
        let half = scaled(self.full, 0.5);
        let full_ms = self.pace.full_ms();
        if pixels(self.drawn_size) < pixels(half) && full_ms > 4.0 * budget {
            // Looked at again at once: a request comes first.
            return self.draw_at(half);
        }
        let moved = self.moved.take();
        let Some(session) = &mut self.session else {
            return;
        };
        if session.view().size == self.full {
            let drawn = session.render_checked();
            match drawn {
                Ok((picture, frame)) => {
                    let is_done = frame.progress.is_whole();
                    if !is_done {
                        // The next frame has more; a request comes first.
                        self.moved = moved;
                    }
                    let keeps_now = is_done && std::mem::take(&mut self.is_kept_later);
                    let warnings = frame.warnings.clone();
                    self.tell(|told| {
                        told.frame = Some(frame);
                        if keeps_now {
                            told.keep(picture);
                        } else {
                            told.refined = Some(Arc::new(picture));
                        }
                    });
                    self.show(warnings);
                }
                Err(findings) => self.show(findings),
            }
        } else {
            self.apply(&Change::Size(self.full), false);
        }
    }

    /// A frame that is not whole yet is followed by others, which have more; what it warns of.
    pub(super) fn expect_more(&mut self, frame: &FrameReport) -> Findings {
        if !frame.progress.is_whole() {
            self.moved.get_or_insert_with(Instant::now);
        }
        frame.warnings.clone()
    }

    /// Shows the last frame, with what is wrong with what was tried after it. What is wrong on disk stays told while the
    /// camera moves.
    pub(super) fn show(&mut self, mut findings: Findings) {
        if findings.is_empty() {
            findings = self.wrong.clone();
        }
        let full = self.full;
        let Some(session) = &mut self.session else {
            return self.tell(|told| {
                told.findings = findings;
                told.is_busy = false;
            });
        };
        let remade = session.take_device_remade();
        let shown = session.display("color");
        let plan = session.shared_plan();
        let looked = plan.graph.outputs.contains_key(LOOK).then(|| {
            let texels = session.texels(LOOK);
            Arc::new(Looked::of(&plan, texels))
        });
        let camera = session.view().camera;
        let scene = session.scene().clone();
        let gpu: Arc<Gpu> = Arc::clone(session.gpu());
        let chosen = session.chosen().cloned();
        let is_refined = session.view().size == full;
        self.tell(|told| {
            if let Some(reason) = remade {
                told.note(Note::new(format!("device opened again: {reason}")));
            }
            told.gpu = Some(gpu);
            told.camera = Some(camera);
            told.plan = Some(plan);
            told.scene = Some(scene);
            told.chosen = chosen;
            told.looked = looked;
            told.is_busy = false;
            told.is_refined = is_refined;
            told.findings = findings;
            match shown {
                Ok(shown) => {
                    told.shown = Some(shown);
                    told.serial += 1;
                }
                Err(why) => told.findings.extend(why),
            }
        });
    }

    /// A device that is lost while nothing is drawn is opened again as well.
    pub(super) fn look_after_device(&mut self) {
        let Some(session) = &mut self.session else {
            return;
        };
        if session.gpu().lost().is_none() {
            return;
        }
        match session.draw() {
            Ok(_) => self.show(Findings::new()),
            Err(findings) => self.tell(|told| told.findings = findings),
        }
    }
}

fn pixels([width, height]: [u32; 2]) -> f64 {
    f64::from(width) * f64::from(height)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of a u32 is one"
)]
fn scaled(size: [u32; 2], share: f64) -> [u32; 2] {
    size.map(|side| ((f64::from(side) * share).round() as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_small_pictures_are_pictures() {
        assert_eq!(scaled([512, 300], 0.375), [192, 113]);
        assert_eq!(scaled([1, 3], 0.125), [1, 1]);
    }
}
