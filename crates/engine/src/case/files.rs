//! Many cases: run side by side, and as one test.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use volgraph_report::Findings;

use super::render::Devices;
use super::{Case, CaseOptions, Outcome, Verdict, find};

/// How many cases are run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// What each is run with.
    pub case: CaseOptions,
    /// Cases that run at the same time, each on a device of its own; at least 1.
    pub jobs: usize,
    /// Whether no case is begun after one has failed.
    pub fail_fast: bool,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            case: CaseOptions::default(),
            jobs: 1,
            fail_fast: false,
        }
    }
}

/// What became of a case.
#[derive(Clone, Debug)]
pub struct CaseReport {
    /// Its file.
    pub file: PathBuf,
    /// What became of its expectations, or why it cannot be run; `None` where it was not begun, after a failure.
    pub result: Option<Result<Vec<Outcome>, Findings>>,
    /// How long it took, in seconds.
    pub seconds: f64,
}

impl CaseReport {
    /// Whether it cannot be run, or one of its expectations does not hold.
    #[must_use]
    pub fn failed(&self) -> bool {
        match &self.result {
            Some(Ok(outcomes)) => outcomes.iter().any(Outcome::failed),
            Some(Err(_)) => true,
            None => false,
        }
    }

    /// The outcomes, none where it could not be run.
    #[must_use]
    pub fn outcomes(&self) -> &[Outcome] {
        match &self.result {
            Some(Ok(outcomes)) => outcomes,
            _ => &[],
        }
    }
}

/// Runs the cases of these files, some side by side, and gives what became of each, in the order of the files. `told` is
/// called as each is done, by one at a time, in that order too.
pub fn run_files(
    files: &[PathBuf],
    options: &RunOptions,
    told: &(dyn Fn(&CaseReport) + Sync),
) -> Vec<CaseReport> {
    let next = AtomicUsize::new(0);
    let is_stopped = AtomicBool::new(false);
    let done: Mutex<(Vec<Option<CaseReport>>, usize)> =
        Mutex::new((files.iter().map(|_| None).collect(), 0));
    let work = || {
        let mut devices = Devices::default();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(file) = files.get(at) else {
                break;
            };
            let start = Instant::now();
            let result = (!is_stopped.load(Ordering::Relaxed)).then(|| {
                Case::load(file).and_then(|case| case.run_on(&options.case, &mut devices))
            });
            let report = CaseReport {
                file: file.clone(),
                result,
                seconds: start.elapsed().as_secs_f64(),
            };
            if options.fail_fast && report.failed() {
                is_stopped.store(true, Ordering::Relaxed);
            }
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            let (reports, count) = &mut *done;
            reports[at] = Some(report);
            while let Some(Some(report)) = reports.get(*count) {
                told(report);
                *count += 1;
            }
        }
    };
    std::thread::scope(|scope| {
        // The caller's own thread is one of them.
        for _ in 1..options.jobs.clamp(1, files.len().max(1)) {
            scope.spawn(work);
        }
        work();
    });
    let (reports, _) = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    reports.into_iter().flatten().collect()
}

/// Runs all cases below a folder on the best adapter: a `#[test]` in one line.
///
/// # Panics
/// With what failed, where anything did; also where there is no case, and for a case of which nothing was run, such as one
/// that only measures times where [`CaseOptions::timing`] is off.
pub fn assert_folder(folder: impl AsRef<Path>) {
    assert_folder_with(folder, &RunOptions::default());
}

/// The same with options.
///
/// # Panics
/// As [`assert_folder`].
pub fn assert_folder_with(folder: impl AsRef<Path>, options: &RunOptions) {
    let failed = match find(&[folder.as_ref().to_path_buf()]) {
        Err(findings) => findings.to_string(),
        Ok(files) => failures(&run_files(&files, options, &|_| {})),
    };
    assert!(failed.is_empty(), "shader tests failed:\n{failed}");
}

/// What a test must not pass with, a line or more each; empty where all is well.
fn failures(reports: &[CaseReport]) -> String {
    let mut failed = String::new();
    for CaseReport { file, result, .. } in reports {
        let file = file.display();
        let outcomes = match result {
            None => {
                failed += &format!("{file}: not begun, after a failure\n");
                continue;
            }
            Some(Err(findings)) => {
                failed += &format!("{file}: it cannot be run\n{findings}\n");
                continue;
            }
            Some(Ok(outcomes)) => outcomes,
        };
        let is_run = |outcome: &Outcome| outcome.verdict != Verdict::NotRun;
        let is_left = !outcomes.iter().any(is_run);
        if is_left && !outcomes.is_empty() {
            failed += &format!("{file}: nothing of it was run\n");
        }
        for outcome in outcomes.iter().filter(|it| it.failed() || is_left) {
            let (name, detail) = (outcome.name(), &outcome.detail);
            failed += &format!("{file}: {name}: {detail}\n");
            if !outcome.findings.is_empty() {
                failed += &format!("{}\n", outcome.findings);
            }
        }
    }
    if reports.iter().all(|report| report.outcomes().is_empty()) && failed.is_empty() {
        failed += "nothing was looked at: no expectation is selected";
    }
    failed
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    #[should_panic(expected = "nothing of it was run")]
    fn a_case_that_was_not_run_has_not_passed() {
        let folder = tempfile::tempdir().unwrap();
        let text =
            "(test: 1, scene: \"fog\", expect: [not_slower(than: [\"image.step=1\"], ratio: 2)])";
        fs::write(folder.path().join("timed.ron"), text).unwrap();
        assert_folder(folder.path());
    }
}
