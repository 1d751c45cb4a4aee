//! `volgraph test`: runs test cases of shaders.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::{Value, json};
use volgraph::case::Outcome;
use volgraph::{AdapterChoice, Case, CaseOptions, Finding, Findings, case};
use volgraph_report::ron_text::Document;

use super::check;
use crate::args::TestArgs;
use crate::output;

pub fn run(args: &TestArgs) -> anyhow::Result<ExitCode> {
    let options = CaseOptions {
        adapter: AdapterChoice::new(args.adapter.as_deref()),
        shader_folders: args.shaders.folders(),
        data: args.data.data.clone(),
    };
    let files = cases(&args.paths)?;
    let mut told = Vec::new();
    let (mut expectations, mut failed, mut broken) = (0, 0, 0);
    for file in &files {
        match Case::load(file).and_then(|case| case.run(&options)) {
            Ok(outcomes) => {
                expectations += outcomes.len();
                failed += outcomes.iter().filter(|outcome| !outcome.passed).count();
                for outcome in &outcomes {
                    if !args.json {
                        output::print(&line(file, outcome));
                    }
                    tell(&outcome.findings);
                    told.push(json(file, outcome));
                }
            }
            Err(findings) => {
                broken += 1;
                if !args.json {
                    output::print(&format!("FAILED  {}: it cannot be run", file.display()));
                }
                tell(&findings);
                told.push(json!({
                    "case": file.display().to_string(), "expectation": null, "passed": false, "measured": null,
                    "bound": null, "detail": "it cannot be run", "findings": check::format::json(&findings),
                }));
            }
        }
    }
    if args.json {
        output::print_json(&Value::Array(told));
    } else {
        let mut summary = format!(
            "{}, {}",
            count(files.len(), "case"),
            count(expectations, "expectation")
        );
        if failed > 0 {
            summary += &format!(", {failed} failed");
        }
        if broken > 0 {
            summary += &format!(", {} cannot be run", count(broken, "case"));
        }
        output::print(&summary);
    }
    Ok(ExitCode::from(u8::from(failed + broken > 0)))
}

/// The case files that these paths name: folders are searched for them, files must be some.
fn cases(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Findings> {
    let mut findings = Findings::new();
    let files = check::files(paths, &mut findings);
    let cases: Vec<PathBuf> = files
        .into_iter()
        .filter(|file| paths.iter().any(|path| is_same(path, file)) || is_case(file))
        .collect();
    if cases.is_empty() && !findings.has_errors() {
        findings.push(
            Finding::error("no-case", "there is no test case here").help(
                "a case is a RON file with `test: 1`; `volgraph new technique NAME` writes one",
            ),
        );
    }
    findings.into_result(cases)
}

fn is_same(path: &Path, file: &Path) -> bool {
    path.strip_prefix(".").unwrap_or(path) == file
}

/// Whether a file that a folder holds is a case. What is no RON at all cannot be told, and `volgraph check` tells it.
fn is_case(file: &Path) -> bool {
    let Ok(text) = check::read(file) else {
        return false;
    };
    Document::parse(file, &text)
        .map_err(Findings::from)
        .and_then(|document| document.fields())
        .is_ok_and(|fields| case::is_case(fields.iter().map(|field| field.name.as_str())))
}

fn tell(findings: &Findings) {
    if !findings.is_empty() {
        output::report(findings);
    }
}

fn line(file: &Path, outcome: &Outcome) -> String {
    let verdict = if outcome.passed { "ok    " } else { "FAILED" };
    format!(
        "{verdict}  {}: {}: {}",
        file.display(),
        outcome.expectation,
        outcome.detail
    )
}

fn json(file: &Path, outcome: &Outcome) -> Value {
    json!({
        "case": file.display().to_string(), "expectation": outcome.expectation, "passed": outcome.passed,
        "measured": outcome.measured, "bound": outcome.bound, "detail": outcome.detail,
        "findings": check::format::json(&outcome.findings),
    })
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
