//! Many cases: found in folders, run side by side, and as one test.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use volgraph_report::ron_text::Document;
use volgraph_report::{Finding, Findings, Place};

use super::render::Devices;
use super::{Case, CaseOptions, Outcome, is_case};

/// Folders deeper than this are not searched.
const MAX_DEPTH: usize = 64;

/// Longer RON files are no cases.
const MAX_BYTES: u64 = 64 << 10;

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

/// The case files that these paths name, sorted, each once: folders are searched for them, files must be some.
///
/// # Errors
/// `io` for what is not there, `no-case` where there is none.
pub fn find(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Findings> {
    let mut findings = Findings::new();
    let mut files = Vec::new();
    for path in paths {
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => search(path, 0, &mut files, &mut findings),
            Ok(_) => files.push(path.clone()),
            Err(error) => findings.push(unreadable(path, &error)),
        }
    }
    let mut files: Vec<PathBuf> = files
        .iter()
        .map(|path| path.strip_prefix(".").unwrap_or(path).to_path_buf())
        .collect();
    files.sort();
    files.dedup();
    if files.is_empty() && !findings.has_errors() {
        findings.push(
            Finding::error("no-case", "there is no test case here").help(
                "a case is a RON file with `test: 1`; `volgraph new technique NAME` writes one",
            ),
        );
    }
    findings.into_result(files)
}

fn search(folder: &Path, depth: usize, files: &mut Vec<PathBuf>, findings: &mut Findings) {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) => return findings.push(unreadable(folder, &error)),
    };
    for entry in entries.flatten() {
        let path = entry.path();
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        // A linked folder may lead back to where it lies.
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_folder && !is_hidden && depth < MAX_DEPTH {
            search(&path, depth + 1, files, findings);
        } else if !is_folder && is_case_file(&path) {
            files.push(path);
        }
    }
}

/// Whether a file that a folder holds is a case. What is no RON at all cannot be told, and `volgraph check` tells it.
fn is_case_file(file: &Path) -> bool {
    let is_ron = file.extension().is_some_and(|extension| extension == "ron");
    let is_short = fs::metadata(file).is_ok_and(|it| it.is_file() && it.len() <= MAX_BYTES);
    if !is_ron || !is_short {
        return false;
    }
    let Ok(text) = fs::read_to_string(file) else {
        return false;
    };
    Document::parse(file, &text)
        .map_err(Findings::from)
        .and_then(|document| document.fields())
        .is_ok_and(|fields| is_case(fields.iter().map(|field| field.name.as_str())))
}

fn unreadable(path: &Path, error: &std::io::Error) -> Finding {
    Finding::error("io", format!("it cannot be read: {error}"))
        .at(Place::whole_file(path))
        .help("check that the path is right and that you may read it")
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
/// With what failed, where anything did; also where there is no case.
pub fn assert_folder(folder: impl AsRef<Path>) {
    assert_folder_with(folder, &RunOptions::default());
}

/// The same with options.
///
/// # Panics
/// As [`assert_folder`].
pub fn assert_folder_with(folder: impl AsRef<Path>, options: &RunOptions) {
    let mut failed = String::new();
    match find(&[folder.as_ref().to_path_buf()]) {
        Err(findings) => failed += &findings.to_string(),
        Ok(files) => {
            let reports = run_files(&files, options, &|_| {});
            for report in &reports {
                let file = report.file.display();
                match &report.result {
                    Some(Err(findings)) => {
                        failed += &format!("{file}: it cannot be run\n{findings}\n");
                    }
                    result => {
                        let outcomes = result.iter().flatten().flatten();
                        for outcome in outcomes.filter(|outcome| outcome.failed()) {
                            let (name, detail) = (outcome.name(), &outcome.detail);
                            failed += &format!("{file}: {name}: {detail}\n");
                            if !outcome.findings.is_empty() {
                                failed += &format!("{}\n", outcome.findings);
                            }
                        }
                    }
                }
            }
            let looked_at = reports
                .iter()
                .map(|report| report.outcomes().len())
                .sum::<usize>();
            if failed.is_empty() && looked_at == 0 {
                failed += "nothing was looked at: no expectation is selected";
            }
        }
    }
    assert!(failed.is_empty(), "shader tests failed:\n{failed}");
}
