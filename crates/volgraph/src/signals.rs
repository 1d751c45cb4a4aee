//! Ctrl-C and a polite kill end the program at once, and leave no half-written picture.
//!
//! A thread waits for the signals, removes what is being written, and then does what the signal does by default, so
//! that a shell sees by which signal the program has ended. Other systems than Unix end it without the cleaning.

/// Starts the thread. Where it cannot be started, signals do what they always do.
#[cfg(unix)]
pub fn leave_nothing_unfinished() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else {
        return;
    };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            volgraph_picture::abandon_unfinished();
            // It does not come back.
            let _ = emulate_default_handler(signal);
        }
    });
}

/// Nothing to do here.
#[cfg(not(unix))]
pub fn leave_nothing_unfinished() {}
