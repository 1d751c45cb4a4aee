//! What the command line prints: results on standard output, findings and warnings on standard error.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use volgraph::{Findings, embedded};
use volgraph_report::excerpt;

/// Whether nobody reads standard output any more.
static IS_CLOSED: AtomicBool = AtomicBool::new(false);

/// Prints a result. A closed pipe (as of `| head`) is no error worth a panic, here and below.
pub fn print(text: &str) {
    let written = writeln!(std::io::stdout().lock(), "{}", text.trim_end());
    if written.is_err_and(|error| error.kind() == ErrorKind::BrokenPipe) {
        IS_CLOSED.store(true, Ordering::Relaxed);
    }
}

/// Whether the last result met a closed pipe: a command that would go on for ever ends then.
pub fn is_closed() -> bool {
    IS_CLOSED.load(Ordering::Relaxed)
}

fn tell(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Prints a value as JSON.
pub fn print_json(value: &serde_json::Value) {
    print(&format!("{value:#}"));
}

/// Prints a warning.
pub fn warn(text: &str) {
    tell(&format!("warning: {text}"));
}

/// Prints what the user should know of, and need not change.
pub fn note(text: &str) {
    tell(&format!("note: {text}"));
}

/// Nobody reads more findings than this at once.
const MAX_SHOWN: usize = 100;

/// Prints the findings with excerpts: all of them, or the first hundred by place and how many more there are.
pub fn report(findings: &Findings) {
    let color = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let sorted = findings.sorted();
    let shown: Findings = sorted
        .iter()
        .take(MAX_SHOWN)
        .map(|finding| (*finding).clone())
        .collect();
    tell(&excerpt::render(&shown, source_text, color));
    if sorted.len() > MAX_SHOWN {
        tell(&format!(
            "\n… and {} more findings",
            sorted.len() - MAX_SHOWN
        ));
    }
}

/// Prints warnings, if there are any.
pub fn report_warnings(warnings: &Findings) {
    if !warnings.is_empty() {
        report(warnings);
    }
}

/// The text of a file for an excerpt: from the disk, or one that volgraph carries.
fn source_text(file: &Path) -> Option<String> {
    match embedded::text(file) {
        Some(text) => Some(text.to_owned()),
        None => excerpt::from_disk(file),
    }
}

/// Prints why a command failed: findings with excerpts, anything else with its causes.
pub fn fail(error: &anyhow::Error) -> ExitCode {
    match error.downcast_ref::<Findings>() {
        Some(findings) => report(findings),
        None => tell(&format!("error: {error:#}")),
    }
    ExitCode::from(1)
}
