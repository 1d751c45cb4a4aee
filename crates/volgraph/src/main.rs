//! The command line: thin. Each command reads its arguments, calls the library, prints, and says how it went.
//!
//! Exit codes: 0 done, 1 findings (all of them printed, with excerpts), 2 wrong usage.

mod args;
mod clock;
mod commands;
mod output;
mod progress;
mod signals;

use std::process::ExitCode;

use clap::Parser;

use crate::args::Args;

fn main() -> ExitCode {
    clock::start();
    quiet_wayland();
    let args = Args::parse();
    signals::leave_nothing_unfinished();
    match commands::run(args.command) {
        Ok(code) => code,
        Err(error) => output::fail(&error),
    }
}

/// Mesa's Vulkan layer asks for a Wayland display, and without this variable its library prints errors, as in
/// containers; a folder without a display in it is taken in silence.
fn quiet_wayland() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: no other thread has been started yet.
        unsafe { std::env::set_var("XDG_RUNTIME_DIR", std::env::temp_dir()) };
    }
}
