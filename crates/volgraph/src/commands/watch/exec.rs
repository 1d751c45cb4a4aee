//! The command that `--exec` runs after each picture.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::output;

/// One command at a time: while it runs, newer pictures wait, and the last of them is told to it next.
pub struct Exec {
    command: String,
    /// Whether standard output is for others, and what the command prints goes to standard error.
    is_quiet: bool,
    child: Option<Child>,
    waiting: Option<(std::path::PathBuf, u64)>,
}

impl Exec {
    /// A shell's command line, and whether it must keep off standard output.
    pub fn new(command: String, is_quiet: bool) -> Self {
        Self {
            command,
            is_quiet,
            child: None,
            waiting: None,
        }
    }

    /// Runs the command for a picture, or as soon as the one before has ended.
    pub fn start(&mut self, picture: &Path, number: u64) {
        self.waiting = Some((picture.to_path_buf(), number));
        self.look_after();
    }

    /// Sees whether the command has ended, tells how it failed, and starts the next. Whether one runs.
    pub fn look_after(&mut self) -> bool {
        if let Some(child) = &mut self.child {
            match child.try_wait() {
                Ok(None) => return true,
                Ok(Some(status)) if status.success() => {}
                Ok(Some(status)) => {
                    output::warn(&format!("`{}` ended with {status}", self.command))
                }
                Err(error) => output::warn(&format!("`{}`: {error}", self.command)),
            }
            self.child = None;
        }
        let Some((picture, number)) = self.waiting.take() else {
            return false;
        };
        let mut command = shell(&self.command);
        command
            .env("VOLGRAPH_PICTURE", picture)
            .env("VOLGRAPH_NUMBER", number.to_string())
            .stdin(Stdio::null());
        if self.is_quiet {
            command.stdout(std::io::stderr());
        }
        match command.spawn() {
            Ok(child) => self.child = Some(child),
            Err(error) => output::warn(&format!("`{}` cannot be run: {error}", self.command)),
        }
        self.child.is_some()
    }
}

fn shell(line: &str) -> Command {
    let (shell, option) = if cfg!(windows) {
        ("cmd", "/C")
    } else {
        ("sh", "-c")
    };
    let mut command = Command::new(shell);
    command.arg(option).arg(line);
    command
}
