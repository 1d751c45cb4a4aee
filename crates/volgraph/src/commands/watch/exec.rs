//! The command that `--exec` runs after each picture.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::output;

/// One command at a time: while it runs, newer pictures wait, and the last of them is told to it next.
pub struct Exec {
    command: String,
    /// What it prints goes to standard error: standard output has JSON.
    is_aside: bool,
    child: Option<Child>,
    waiting: Option<(std::path::PathBuf, u64)>,
}

impl Exec {
    /// A shell's command line. `is_aside` keeps what it prints off standard output.
    pub fn new(command: String, is_aside: bool) -> Self {
        Self {
            command,
            is_aside,
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
                    output::warn(&format!("`{}` ended with {status}", self.command));
                }
                Err(error) => output::warn(&format!("`{}`: {error}", self.command)),
            }
            self.child = None;
        }
        let Some((picture, number)) = self.waiting.take() else {
            return false;
        };
        let stdout = if self.is_aside {
            Stdio::from(std::io::stderr())
        } else {
            Stdio::inherit()
        };
        let started = shell(&self.command)
            .env("VOLGRAPH_PICTURE", picture)
            .env("VOLGRAPH_NUMBER", number.to_string())
            .stdin(Stdio::null())
            .stdout(stdout)
            .spawn();
        match started {
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
