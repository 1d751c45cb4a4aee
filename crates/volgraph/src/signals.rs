//! Ctrl-C and a polite kill end the program at once, and leave no half-written file.
//!
//! A thread waits for the signals, removes what is being written, and then does what the signal does by default, so
//! that a shell sees by which signal the program has ended. Work that writes volumes cleans up itself: while an
//! [`Interrupt`] watches, the first signal asks it to stop, and the second ends the program as ever. Other systems than
//! Unix end it without the cleaning.

use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The work that cleans up itself, where there is any.
static WATCHED: Mutex<Option<Arc<AtomicBool>>> = Mutex::new(None);

/// The signal that came while work was watched.
static CAME: AtomicI32 = AtomicI32::new(0);

/// Work that is asked to stop before the program ends.
#[derive(Clone)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// From here on the first signal sets the flag.
    pub fn watch() -> Self {
        let flag = Arc::new(AtomicBool::new(false));
        *WATCHED.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(&flag));
        Self(flag)
    }

    /// True once the work is to stop.
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }

    /// The work has stopped: where a signal asked for that, the program ends by it.
    pub fn end_as_the_signal_does(self) {
        *WATCHED.lock().unwrap_or_else(PoisonError::into_inner) = None;
        self.end_if_asked();
    }

    /// Ends the program where a signal asked for that, while there is nothing to be cleaned up yet.
    pub fn end_if_asked(&self) {
        let signal = CAME.load(Ordering::SeqCst);
        if signal != 0 {
            end_by(signal);
        }
    }
}

/// Starts the thread. Where it cannot be started, signals do what they always do.
#[cfg(unix)]
pub fn leave_nothing_unfinished() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else {
        return;
    };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            let watched = WATCHED.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(flag) = &*watched
                && !flag.swap(true, Ordering::SeqCst)
            {
                CAME.store(signal, Ordering::SeqCst);
                continue;
            }
            drop(watched);
            volgraph_picture::abandon_unfinished();
            end_by(signal);
        }
    });
}

#[cfg(unix)]
fn end_by(signal: i32) {
    // It does not come back.
    let _ = signal_hook::low_level::emulate_default_handler(signal);
}

/// Nothing to do here.
#[cfg(not(unix))]
pub fn leave_nothing_unfinished() {}

#[cfg(not(unix))]
fn end_by(_signal: i32) {}
