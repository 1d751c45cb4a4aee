//! The command line: thin. Each command reads its arguments, calls the library, prints, and says how it went.
//!
//! Exit codes: 0 done, 1 findings (all of them printed, with excerpts), 2 wrong usage.

mod args;
mod commands;
mod output;
mod progress;

use std::process::ExitCode;

use clap::Parser;

use crate::args::Args;

fn main() -> ExitCode {
    let args = Args::parse();
    match commands::run(args.command) {
        Ok(code) => code,
        Err(error) => output::fail(&error),
    }
}
