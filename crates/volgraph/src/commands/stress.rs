//! `volgraph stress`: the known breaking points of volume rendering, as a table and as a page.

mod curve;
mod page;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::process::ExitCode;
use std::time::Instant;

use serde_json::json;
use volgraph::stress::{Case, CaseReport, Stand, Verdict, cases};
use volgraph::{AdapterChoice, Finding, Findings};

use crate::args::StressArgs;
use crate::output;
use crate::progress::Bars;

pub fn run(args: &StressArgs) -> anyhow::Result<ExitCode> {
    let folders = args.shaders.folders();
    let mut all = cases(&folders);
    all.retain(|case| {
        args.filter.is_empty()
            || args
                .filter
                .iter()
                .any(|text| case.name.contains(text.as_str()))
    });
    if all.is_empty() {
        let finding = Finding::error("no-case", "no case has that text in its name");
        return Err(Findings::from(finding.help("`volgraph stress --list` lists them")).into());
    }
    if args.list {
        list(&all, args.json);
        return Ok(ExitCode::SUCCESS);
    }
    let start = Instant::now();
    let mut stand = Stand::open(&AdapterChoice::new(args.adapter.as_deref()), &folders)?;
    let adapter = stand.adapter();
    let bars = Bars::new();
    let mut reports = Vec::new();
    for (done, case) in all.iter().enumerate() {
        bars.count("drawing breaking points", done as u64, all.len() as u64);
        let report = stand.run(case)?;
        if !args.json {
            output::print(&table(&report));
        }
        reports.push(report);
    }
    bars.clear();
    let seconds = start.elapsed().as_secs_f64();
    if let Some(folder) = &args.output {
        page::write(folder, &reports, &adapter, seconds)?;
    }
    let counts = counts(&reports);
    if args.json {
        output::print_json(&json!({
            "adapter": adapter, "seconds": seconds, "verdicts": counts, "cases": reports,
        }));
    } else {
        let all: Vec<String> = counts
            .iter()
            .map(|(words, count)| format!("{count} {words}"))
            .collect();
        output::print(&format!(
            "{} cases on {adapter} in {seconds:.0} s: {}",
            reports.len(),
            all.join(", ")
        ));
        if let Some(folder) = &args.output {
            output::print(&format!("{}", folder.join("index.html").display()));
        }
    }
    Ok(if reports.iter().any(CaseReport::is_broken) {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    })
}

fn list(cases: &[Case], is_json: bool) {
    if is_json {
        let all: Vec<_> = cases
            .iter()
            .map(|case| json!({ "name": case.name, "breaks": case.breaks, "swept": case.swept }))
            .collect();
        output::print_json(&json!(all));
        return;
    }
    for case in cases {
        output::print(&format!("{:<26} {}", case.name, case.breaks));
    }
}

/// How often each verdict came.
fn counts(reports: &[CaseReport]) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for method in reports.iter().flat_map(|report| &report.methods) {
        *counts.entry(method.verdict.words()).or_default() += 1;
    }
    counts
}

/// A case as lines: each method with what came, where it was worst, and the bound there.
fn table(report: &CaseReport) -> String {
    let mut text = format!("{} ({:.1} s)\n", report.name, report.seconds);
    for method in &report.methods {
        let worst = method.worst();
        let bound = if worst.bound.is_finite() {
            format!("bound {:.1e}", worst.bound)
        } else {
            "no bound".to_owned()
        };
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "  {:<28} {:<15} {} ({bound}) at {}",
            method.name,
            method.verdict.words(),
            worst.words(),
            report.labels[method.worst]
        );
        if method.verdict == Verdict::Broken {
            for (label, measured) in report.labels.iter().zip(&method.points) {
                let mark = if measured.holds() { " " } else { "!" };
                let _ = writeln!(
                    text,
                    "    {mark} {label}: {} (bound {:.1e})",
                    measured.words(),
                    measured.bound
                );
            }
        }
    }
    text
}
