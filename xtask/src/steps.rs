//! Runs commands, shows them, and keeps their times.

#![expect(
    clippy::print_stderr,
    reason = "telling people what goes on is this module's work"
)]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Why a task ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What to tell; empty where a command has told it.
    pub text: String,
    /// The exit code.
    pub code: u8,
}

impl Failure {
    /// A failure with exit code 1.
    pub fn new(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            code: 1,
        }
    }
}

/// Prints to standard error, so that standard output stays what the commands print.
pub fn tell(text: &str) {
    if !text.is_empty() {
        eprintln!("{text}");
    }
}

/// The repository's folder.
pub fn root() -> &'static Path {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own)
}

/// The cargo that runs this.
pub fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

/// The volgraph that [`cargo`] built in the profile that this was built in: it lies in the same folder.
pub fn volgraph() -> Option<PathBuf> {
    let name = format!("volgraph{}", std::env::consts::EXE_SUFFIX);
    let path = std::env::current_exe().ok()?.with_file_name(name);
    path.is_file().then_some(path)
}

/// Whether a command can be started and ends well; it prints nothing.
pub fn succeeds(command: &mut Command) -> bool {
    command.stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// What a command that ends well prints.
pub fn output_of(command: &mut Command) -> Option<String> {
    let output = command.stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    output.status.success().then_some(text)
}

/// The steps that were run, with their times.
#[derive(Debug, Default)]
pub struct Steps {
    done: Vec<(&'static str, Duration)>,
}

impl Steps {
    /// Runs a command with its output shown.
    ///
    /// # Errors
    /// Where it cannot be started, or ends badly: with its exit code.
    pub fn run(&mut self, name: &'static str, command: &mut Command) -> Result<(), Failure> {
        tell(&format!("xtask: {name}: {}", shown(command)));
        let start = Instant::now();
        let status = command.status().map_err(|error| {
            Failure::new(format!(
                "error: {} cannot be started: {error}",
                shown(command)
            ))
        })?;
        self.done.push((name, start.elapsed()));
        if status.success() {
            return Ok(());
        }
        let code = status.code().and_then(|code| u8::try_from(code).ok());
        Err(Failure {
            text: format!("error: {name} failed: {}", shown(command)),
            code: code.unwrap_or(1),
        })
    }

    /// One line with all times so far.
    pub fn times(&self) -> String {
        let mut line = "xtask: times:".to_owned();
        for (index, (name, time)) in self.done.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            // Writing to a string cannot fail.
            let _ = write!(line, "{comma} {name} {:.1} s", time.as_secs_f64());
        }
        line
    }
}

/// A command as one would type it.
pub fn shown(command: &Command) -> String {
    let path = Path::new(command.get_program());
    let program = path.file_name().unwrap_or(command.get_program());
    let mut line = program.to_string_lossy().into_owned();
    for arg in command.get_args() {
        let arg = arg.to_string_lossy();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_=./+:,".contains(c);
        if !arg.is_empty() && arg.chars().all(is_plain) {
            let _ = write!(line, " {arg}");
        } else {
            let _ = write!(line, " '{arg}'");
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_shown_as_typed() {
        let mut command = Command::new("/usr/bin/cargo");
        command.args(["test", "--workspace", "-E", "test(a b)"]);
        assert_eq!(shown(&command), "cargo test --workspace -E 'test(a b)'");
    }

    #[cfg(unix)]
    #[test]
    fn a_bad_end_keeps_its_code_and_a_missing_program_is_told() {
        let mut steps = Steps::default();
        let failure = steps.run("shell", Command::new("sh").args(["-c", "exit 2"]));
        assert_eq!(failure.map_err(|failure| failure.code), Err(2));
        let missing = steps.run("gone", &mut Command::new("no-such-program-as-this"));
        assert!(missing.is_err_and(|failure| failure.text.contains("cannot be started")));
        assert!(steps.times().starts_with("xtask: times: shell "));
        assert!(succeeds(&mut Command::new("true")) && !succeeds(&mut Command::new("false")));
        assert_eq!(
            output_of(Command::new("echo").arg("a")).as_deref(),
            Some("a\n")
        );
    }
}
