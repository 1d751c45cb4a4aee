//! Progress bars: on a terminal, for what takes longer than a second; none in a pipe.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use volgraph::SourceProgress;

/// Shown only after this long.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar for one piece of work after the other.
pub struct Bars {
    state: Mutex<State>,
}

struct State {
    name: String,
    started: Instant,
    bar: Option<ProgressBar>,
}

impl Bars {
    /// No work yet.
    pub fn new() -> Self {
        Self {
            state: Mutex::new(State {
                name: String::new(),
                started: Instant::now(),
                bar: None,
            }),
        }
    }

    /// Says how much of a piece of work is done; `total` is 0 where it is unknown.
    pub fn update(&self, name: &str, done: u64, total: u64) {
        let template = "{msg} [{bar:30}] {bytes}/{total_bytes} {bytes_per_sec} {eta}";
        self.show(name, done, total, template);
    }

    /// The same of work that is counted in pieces.
    pub fn count(&self, name: &str, done: u64, total: u64) {
        self.show(name, done, total, "{msg} [{bar:30}] {pos}/{len} {eta}");
    }

    fn show(&self, name: &str, done: u64, total: u64, template: &str) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if state.name != name {
            if let Some(bar) = state.bar.take() {
                bar.finish_and_clear();
            }
            name.clone_into(&mut state.name);
            state.started = Instant::now();
        }
        if state.bar.is_none() && state.started.elapsed() > PATIENCE {
            // Drawn on standard error, and not at all where that is no terminal.
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.set_message(name.to_owned());
            state.bar = Some(bar);
        }
        if let Some(bar) = &state.bar {
            if total > 0 {
                bar.set_length(total);
            }
            bar.set_position(done);
            if total > 0 && done >= total {
                bar.finish_and_clear();
            }
        }
    }

    /// Takes away what is shown.
    pub fn clear(&self) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(bar) = state.bar.take() {
            bar.finish_and_clear();
        }
    }
}

impl SourceProgress for Bars {
    fn progress(&self, source: &str, done: u64, total: u64) {
        self.update(&format!("reading {source}"), done, total);
    }
}
