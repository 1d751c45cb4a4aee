//! The bar of time: a slider over the steps of volumes that have several, and playing them one after the other.
//!
//! While it plays, the next step is asked for when the picture of the last one is there: no step is left out, and the rate is
//! at most the one that was asked for. Steps ahead are read while this one is drawn (the source kind `volume` does that).

use std::time::{Duration, Instant};

use egui::{Slider, Ui};
use volgraph_engine::ParamOverride;

use crate::worker::{Request, Told};

/// What the bar remembers.
pub(super) struct TimeBar {
    is_playing: bool,
    /// Steps per second, at most.
    rate: f64,
    /// The step that was asked for last, when, and the number of the picture then.
    asked: Option<(u32, Instant, u64)>,
}

impl Default for TimeBar {
    fn default() -> Self {
        Self {
            is_playing: false,
            rate: 10.0,
            asked: None,
        }
    }
}

impl TimeBar {
    /// Whether there is anything to show.
    pub fn is_needed(told: &Told) -> bool {
        told.scene
            .as_ref()
            .is_some_and(|scene| !scene.series().is_empty())
    }

    /// The bar; what it asks for.
    pub fn show(&mut self, ui: &mut Ui, told: &Told) -> Vec<Request> {
        let Some(scene) = &told.scene else {
            return Vec::new();
        };
        let series = scene.series();
        // Volumes of different length go together as long as the shortest.
        let Some(count) = series.iter().map(|(_, _, count)| *count).min() else {
            return Vec::new();
        };
        let shown = series.first().map_or(0, |(_, step, _)| *step);
        let mut step = shown;
        ui.horizontal(|ui| {
            let name = if self.is_playing { "Pause" } else { "Play" };
            if ui.button(name).clicked() {
                self.is_playing = !self.is_playing;
                self.asked = None;
            }
            ui.spacing_mut().slider_width = (ui.available_width() - 260.0).max(80.0);
            let slider = Slider::new(&mut step, 0..=count - 1).text("time step");
            if ui.add(slider).changed() {
                self.is_playing = false;
            }
            let rate = egui::DragValue::new(&mut self.rate)
                .range(0.1..=60.0)
                .speed(0.1)
                .suffix(" steps/s");
            ui.add(rate).on_hover_text("how fast it plays, at most");
        });
        if self.is_playing {
            step = self.next(ui, told, shown, count);
        }
        let is_asked = self.asked.is_some_and(|(asked, ..)| asked == step);
        if step == shown || (is_asked && told.is_busy) {
            return Vec::new();
        }
        self.asked = Some((step, Instant::now(), told.serial));
        let sets = series
            .iter()
            .filter_map(|(source, ..)| ParamOverride::parse(&format!("{source}.time={step}")).ok());
        vec![Request::Set(sets.collect())]
    }

    /// The step to be shown now while it plays: the next one where this one has been seen long enough.
    fn next(&self, ui: &Ui, told: &Told, shown: u32, count: u32) -> u32 {
        let each = Duration::from_secs_f64(1.0 / self.rate);
        ui.ctx()
            .request_repaint_after(each.min(Duration::from_millis(50)));
        let is_due = self.asked.is_none_or(|(asked, at, serial)| {
            // A step that was refused is not asked for again and again.
            (asked == shown && told.serial != serial || !told.is_busy) && at.elapsed() >= each
        });
        if is_due { (shown + 1) % count } else { shown }
    }
}
