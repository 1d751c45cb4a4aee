//! `cargo xtask`: the repository's own tasks, so that there is one way to do each.
//!
//! The way of the data: [`args`] turns the words of the command line into a [`Task`]; [`tasks`] runs it as a list of
//! [`steps`], each a command whose time is told; [`setup`] looks at the machine ([`system`]), says what building and
//! running volgraph lacks there, and installs it where it may. The decisions are functions over plain values.

mod args;
mod fuzz;
mod gallery;
mod setup;
mod steps;
mod system;
mod tasks;

use std::process::ExitCode;

use args::Task;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match Task::parse(&words) {
        Ok(task) => match tasks::run(task) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => {
                steps::tell(&failure.text);
                ExitCode::from(failure.code)
            }
        },
        Err(cause) => {
            steps::tell(&format!("{cause}\n\n{}", args::USAGE));
            ExitCode::from(2)
        }
    }
}
