//! When the program started, for what is told from there.

use std::sync::OnceLock;
use std::time::Instant;

static STARTED: OnceLock<Instant> = OnceLock::new();

/// Called first of all.
pub fn start() {
    let _ = STARTED.set(Instant::now());
}

/// Milliseconds since then.
pub fn milliseconds() -> f64 {
    STARTED.get_or_init(Instant::now).elapsed().as_secs_f64() * 1e3
}
