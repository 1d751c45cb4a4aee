//! `volgraph test`: runs test cases of shaders.
//!
//! The way of the data: paths become case files ([`volgraph::case::find`]); each is run ([`volgraph::case::run_files`]),
//! some side by side, and told as soon as all before it are done; what became of all goes into a summary line, and on
//! demand into JUnit XML ([`junit`]) and a page for people ([`page`]).

mod chart;
mod junit;
mod page;
mod pictures;

use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;

use serde_json::{Value, json};
use volgraph::case::{
    self, CaseReport, Outcome, RunOptions, STOCK_SCENES, Selection, Verdict, run_files,
};
use volgraph::{AdapterChoice, Case, CaseOptions, Finding, Findings};

use super::{check, write};
use crate::args::TestArgs;
use crate::output;

/// More jobs than these seldom help: each case keeps a device busy by itself.
const DEFAULT_JOBS: usize = 4;

pub fn run(args: &TestArgs) -> anyhow::Result<ExitCode> {
    if args.scenes {
        list_scenes(args.json);
        return Ok(ExitCode::SUCCESS);
    }
    let options = options(args);
    let files = case::find(&args.paths)?;
    if args.list {
        return list(&files, &options.case, args.json);
    }
    if let Some(folder) = &args.html {
        write::folder(folder)?;
    }
    let told = |report: &CaseReport| tell(report, args.json);
    let reports = run_files(&files, &options, &told);
    if !args.json {
        output::print(&summary(&reports));
    }
    if args.json {
        let outcomes = reports.iter().flat_map(json_of);
        output::print_json(&Value::Array(outcomes.collect()));
    }
    if let Some(file) = &args.junit {
        let text = junit::xml(&reports)?;
        write::whole(file, text)?;
    }
    if let Some(folder) = &args.html {
        page::write(folder, &reports, &options.case)?;
        if !args.json {
            let page = folder.join("index.html");
            output::note(&format!("the page is {}", page.display()));
        }
    }
    let is_empty = reports
        .iter()
        .all(|report| matches!(&report.result, Some(Ok(outcomes)) if outcomes.is_empty()));
    if is_empty {
        return Err(nothing_selected(args).into());
    }
    let is_skipped = |report: &CaseReport| {
        let all = |outcomes: &Vec<Outcome>| {
            let mut outcomes = outcomes.iter();
            outcomes.all(|outcome| outcome.verdict == Verdict::NotRun)
        };
        matches!(&report.result, Some(Ok(outcomes)) if all(outcomes))
    };
    if reports.iter().all(is_skipped) {
        return Err(nothing_run().into());
    }
    let failed = reports.iter().any(CaseReport::failed);
    Ok(ExitCode::from(u8::from(failed)))
}

fn options(args: &TestArgs) -> RunOptions {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let jobs = args.jobs.map_or(cores.min(DEFAULT_JOBS), usize::from);
    RunOptions {
        case: CaseOptions {
            adapter: AdapterChoice::new(args.adapter.as_deref()),
            shader_folders: args.shaders.folders(),
            data: args.data.data.clone(),
            selection: Selection {
                words: args.filter.clone(),
                exact: args.exact,
            },
            timing: args.timing,
            bless: args.bless,
            keep_pictures: args.html.is_some(),
        },
        // What else runs would be timed as well.
        jobs: if args.timing { 1 } else { jobs },
        fail_fast: args.fail_fast,
    }
}

fn list_scenes(is_json: bool) {
    if is_json {
        let scenes = STOCK_SCENES.iter().map(|scene| {
            json!({ "name": scene.name, "doc": scene.doc, "graph": scene.path().display().to_string() })
        });
        output::print_json(&Value::Array(scenes.collect()));
        return;
    }
    for scene in STOCK_SCENES {
        output::print(&format!(
            "{}: {} ({})",
            scene.name,
            scene.doc,
            scene.path().display()
        ));
    }
}

fn list(files: &[PathBuf], options: &CaseOptions, is_json: bool) -> anyhow::Result<ExitCode> {
    let mut findings = Findings::new();
    let mut names = Vec::new();
    for file in files {
        let listed = Case::load(file).and_then(|case| case.names(options));
        for name in findings.take_all(listed).unwrap_or_default() {
            names.push(format!("{}: {name}", file.display()));
        }
    }
    if is_json {
        output::print_json(&json!(names));
    } else {
        for name in &names {
            output::print(name);
        }
    }
    findings.into_result(())?;
    Ok(ExitCode::SUCCESS)
}

/// Tests that look at nothing hold nothing.
fn nothing_run() -> Findings {
    Finding::error(
        "nothing-run",
        "no expectation was looked at, for the reasons above",
    )
    .help("give what they need: data by `--data`, another adapter by `--adapter`")
    .into()
}

fn nothing_selected(args: &TestArgs) -> Findings {
    let message = format!("nothing is named `{}`", args.filter.join("` or `"));
    Finding::error("no-case", message)
        .help("`volgraph test --list` lists the names")
        .into()
}

/// Tells what became of a case: expectations that hold at many settings in one line.
fn tell(report: &CaseReport, is_json: bool) {
    let file = report.file.display();
    match &report.result {
        None => {
            if !is_json {
                output::print(&format!("not run {file}: a case before it failed"));
            }
        }
        Some(Err(findings)) => {
            if !is_json {
                output::print(&format!("FAILED  {file}: it cannot be run"));
            }
            output::report(findings);
        }
        Some(Ok(outcomes)) => {
            let mut at = 0;
            while let Some(first) = outcomes.get(at) {
                let rest = &outcomes[at..];
                let is_same = |outcome: &&Outcome| outcome.expectation == first.expectation;
                let same = &rest[..rest.iter().take_while(is_same).count()];
                at += same.len();
                if !is_json {
                    lines(&report.file, same)
                        .iter()
                        .for_each(|it| output::print(it));
                }
            }
            // What many expectations fail by is told once.
            let findings: Findings = outcomes
                .iter()
                .flat_map(|outcome| outcome.findings.clone())
                .collect();
            if !findings.is_empty() {
                output::report(&findings);
            }
        }
    }
}

/// The lines about one expectation: one for all settings where it holds, one for each where it does not.
fn lines(file: &Path, outcomes: &[Outcome]) -> Vec<String> {
    let file = file.display();
    let passed: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.passed()).collect();
    let mut lines = Vec::new();
    if let Some(nearest) = passed
        .iter()
        .max_by(|a, b| nearness(a).total_cmp(&nearness(b)))
    {
        lines.push(match passed.as_slice() {
            [_] => format!("ok      {file}: {}: {}", nearest.name(), nearest.detail),
            many => format!(
                "ok      {file}: {} at {} settings: nearest to its bound with {}: {}",
                nearest.expectation,
                many.len(),
                if nearest.point.is_empty() {
                    "nothing set"
                } else {
                    &nearest.point
                },
                nearest.detail
            ),
        });
    }
    for outcome in outcomes.iter().filter(|outcome| !outcome.passed()) {
        let verdict = match outcome.verdict {
            Verdict::NotRun => "not run",
            _ => "FAILED ",
        };
        lines.push(format!(
            "{verdict} {file}: {}: {}",
            outcome.name(),
            outcome.detail
        ));
    }
    lines
}

/// How near a figure is to its bound, from whichever side.
fn nearness(outcome: &Outcome) -> f64 {
    match (outcome.measured, outcome.bound) {
        (Some(measured), Some(bound)) if bound != 0.0 => {
            let ratio = measured / bound;
            if ratio > 1.0 { 1.0 / ratio } else { ratio }
        }
        _ => 0.0,
    }
}

fn summary(reports: &[CaseReport]) -> String {
    let outcomes = || reports.iter().flat_map(CaseReport::outcomes);
    let failed = outcomes().filter(|outcome| outcome.failed()).count();
    let not_run = outcomes()
        .filter(|outcome| outcome.verdict == Verdict::NotRun)
        .count();
    let broken = reports
        .iter()
        .filter(|report| matches!(report.result, Some(Err(_))))
        .count();
    let left = reports
        .iter()
        .filter(|report| report.result.is_none())
        .count();
    let mut summary = format!(
        "{}, {}",
        count(reports.len(), "case"),
        count(outcomes().count() - not_run, "expectation")
    );
    if failed > 0 {
        summary += &format!(", {failed} failed");
    }
    if not_run > 0 {
        summary += &format!(", {not_run} not run");
    }
    if broken > 0 {
        summary += &format!(", {} cannot be run", count(broken, "case"));
    }
    if left > 0 {
        summary += &format!(", {} not begun", count(left, "case"));
    }
    summary
}

fn json_of(report: &CaseReport) -> Vec<Value> {
    let file = report.file.display().to_string();
    match &report.result {
        None => vec![json!({
            "case": file, "expectation": null, "point": null, "passed": null, "measured": null, "bound": null,
            "detail": "a case before it failed", "seconds": 0, "findings": [],
        })],
        Some(Err(findings)) => vec![json!({
            "case": file, "expectation": null, "point": null, "passed": false, "measured": null, "bound": null,
            "detail": "it cannot be run", "seconds": report.seconds, "findings": check::format::json(findings),
        })],
        Some(Ok(outcomes)) => outcomes
            .iter()
            .map(|outcome| {
                let passed = match outcome.verdict {
                    Verdict::Passed => json!(true),
                    Verdict::Failed => json!(false),
                    Verdict::NotRun => Value::Null,
                };
                json!({
                    "case": file, "expectation": outcome.expectation, "point": outcome.point, "passed": passed,
                    "measured": outcome.measured, "bound": outcome.bound, "detail": outcome.detail,
                    "seconds": outcome.seconds, "curve": outcome.curve,
                    "findings": check::format::json(&outcome.findings),
                })
            })
            .collect(),
    }
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
