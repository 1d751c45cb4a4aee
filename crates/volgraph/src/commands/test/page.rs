//! The page of `volgraph test --html`: for each case its pictures, differences and curves, and what was measured.

use std::fs;
use std::path::Path;

use maud::{Markup, PreEscaped, html};
use volgraph::case::{CaseReport, Outcome, Verdict};
use volgraph::{CaseOptions, Findings};
use volgraph_gpu::Gpu;

use super::chart::{self, Plot};
use super::pictures::{Pictures, difference};
use super::summary;
use crate::commands::html::Page;
use crate::commands::write;

const STYLE: &str = "
    section { background: #1f2226; border-radius: 6px; padding: .4rem 1rem 1rem; margin: 1rem 0; }
    h1 { font-size: 1.5rem; }
    table { border-collapse: collapse; width: 100%; }
    td, th { text-align: left; vertical-align: top; padding: .3rem .8rem .3rem 0; border-top: 1px solid #2d3136; }
    td.figures { min-width: 16rem; color: #b3bcc5; }
    code { font: 13px/1.4 ui-monospace, monospace; color: #e8ecf0; overflow-wrap: anywhere; }
    .passed { color: #7cc47f; } .failed { color: #ff8272; font-weight: 600; } .not_run { color: #d9b45b; }
    .pictures { display: flex; flex-wrap: wrap; gap: .6rem; margin: .4rem 0; }
    figure { margin: 0; max-width: 12rem; }
    img { display: block; width: 9rem; height: auto; image-rendering: pixelated; background: #000; }
    figcaption { font-size: 12px; color: #93a0ad; overflow-wrap: anywhere; }
    svg { max-width: 100%; height: auto; }
    .note { color: #93a0ad; }
";

/// Passed expectations of one kind whose pictures are shown; of those that failed all are.
const SHOWN_PASSED: usize = 3;

/// Writes the page and its pictures.
pub fn write(folder: &Path, reports: &[CaseReport], options: &CaseOptions) -> anyhow::Result<()> {
    let mut pictures = Pictures::new(folder);
    let mut cases = Vec::new();
    for (number, report) in reports.iter().enumerate() {
        cases.push(case(number, report, &mut pictures)?);
    }
    let adapter = match Gpu::open(&options.adapter) {
        Ok(gpu) => gpu.adapter().to_string(),
        Err(error) => error.to_string(),
    };
    let body = html! {
        h1 { "volgraph: shader tests" }
        p { (summary(reports)) "." }
        p class="note" {
            "Errors are of linear, premultiplied RGBA: rmse over all components, max of one. Pictures are sRGB over "
            "their background. A raycast runs in the fragment shader unless the case says otherwise. A difference is "
            "absolute, in linear light, times the factor below it."
        }
        (contents(reports))
        @for case in &cases { (case) }
    };
    let page = Page {
        title: "volgraph: shader tests",
        style: STYLE,
        adapter: &adapter,
    };
    write::whole(&folder.join("index.html"), page.around(&body))?;
    Ok(())
}

/// All cases with their verdicts, what failed first.
fn contents(reports: &[CaseReport]) -> Markup {
    let mut order: Vec<(usize, &CaseReport)> = reports.iter().enumerate().collect();
    order.sort_by_key(|(_, report)| !report.failed());
    html! {
        section {
            table {
                @for (number, report) in order {
                    tr {
                        td class=(if report.failed() { "failed" } else if report.result.is_none() { "not_run" } else { "passed" }) {
                            (if report.failed() { "FAILED" } else if report.result.is_none() { "not begun" } else { "ok" })
                        }
                        td { a href=(format!("#case-{number}")) { (report.file.display()) } }
                        td { (report.outcomes().len()) " expectations" }
                        td { (format!("{:.1} s", report.seconds)) }
                    }
                }
            }
        }
    }
}

fn case(number: usize, report: &CaseReport, pictures: &mut Pictures<'_>) -> anyhow::Result<Markup> {
    let mut rows = Vec::new();
    let outcomes = report.outcomes();
    let mut at = 0;
    while let Some(first) = outcomes.get(at) {
        let is_same = |outcome: &&Outcome| outcome.expectation == first.expectation;
        let same = &outcomes[at..];
        let same = &same[..same.iter().take_while(is_same).count()];
        at += same.len();
        rows.push(expectation(same, pictures)?);
    }
    let text = fs::read_to_string(&report.file).unwrap_or_default();
    Ok(html! {
        section id=(format!("case-{number}")) {
            h2 { (report.file.display()) }
            @match &report.result {
                None => p class="not_run" { "not begun: a case before it failed" },
                Some(Err(findings)) => {
                    p class="failed" { "it cannot be run" }
                    pre { (findings) }
                },
                Some(Ok(_)) => table { @for row in &rows { (row) } },
            }
            details { summary { "the case" } pre { (text) } }
        }
    })
}

/// One expectation at all of its settings.
fn expectation(outcomes: &[Outcome], pictures: &mut Pictures<'_>) -> anyhow::Result<Markup> {
    let mut rows = Vec::new();
    let mut shown = 0;
    for outcome in outcomes {
        let is_shown = outcome.failed() || shown < SHOWN_PASSED;
        shown += usize::from(outcome.passed());
        let shown = if is_shown {
            figures(outcome, pictures)?
        } else {
            html! {}
        };
        rows.push((outcome, shown, curve(outcome)?));
    }
    let swept = swept(outcomes)?;
    Ok(html! {
        @for (outcome, shown, curve) in &rows {
            tr {
                td class=(class(outcome.verdict)) { (word(outcome.verdict)) }
                td {
                    code { (outcome.expectation) }
                    @if !outcome.point.is_empty() { br; span class="note" { "with " code { (outcome.point) } } }
                    (shown)
                    @if let Some(curve) = curve { (PreEscaped(curve)) }
                    @if !outcome.findings.is_empty() { pre { (outcome.findings) } }
                }
                td class="figures" { (outcome.detail) }
            }
        }
        @if let Some(curve) = swept {
            tr { td {} td { span class="note" { "over what is swept" } br; (PreEscaped(curve)) } td {} }
        }
    })
}

/// The pictures of an outcome, and the difference of the first two.
fn figures(outcome: &Outcome, pictures: &mut Pictures<'_>) -> anyhow::Result<Markup> {
    let mut all = Vec::new();
    for shown in &outcome.pictures {
        all.push((pictures.file(&shown.picture)?, shown.name.clone()));
    }
    let differing = match outcome.pictures.as_slice() {
        [a, b, ..] => Some(difference(&a.picture, &b.picture)),
        _ => None,
    };
    if let Some(differing) = differing {
        match differing {
            None => all.push((String::new(), "no difference".to_owned())),
            Some((picture, scale)) => {
                let caption = format!("difference × {scale}");
                all.push((pictures.difference(&picture)?, caption));
            }
        }
    }
    Ok(html! {
        @if !all.is_empty() {
            div class="pictures" {
                @for (file, caption) in &all {
                    figure {
                        @if !file.is_empty() { a href=(file) { img src=(file) alt=(caption) loading="lazy"; } }
                        figcaption { (caption) }
                    }
                }
            }
        }
    })
}

/// The errors over a parameter that was halved.
fn curve(outcome: &Outcome) -> Result<Option<String>, Findings> {
    let Some(curve) = &outcome.curve else {
        return Ok(None);
    };
    let is_order = outcome.expectation.starts_with("order(");
    chart::svg(&Plot {
        x: &curve.name,
        y: "rmse",
        points: &curve.points,
        order: outcome.bound.filter(|_| is_order),
        bound: outcome.bound.filter(|_| !is_order),
    })
}

/// What was measured over the one number that is swept, where it is swept over three values or more.
fn swept(outcomes: &[Outcome]) -> Result<Option<String>, Findings> {
    let at = |outcome: &Outcome| -> Option<(String, f64, f64)> {
        let (name, value) = outcome.point.split_once('=')?;
        Some((name.to_owned(), value.parse().ok()?, outcome.measured?))
    };
    let points: Option<Vec<_>> = outcomes.iter().map(at).collect();
    let Some(points) = points.filter(|points| points.len() >= 3) else {
        return Ok(None);
    };
    let name = &points[0].0;
    if points.iter().any(|(other, ..)| other != name) {
        return Ok(None);
    }
    let values: Vec<(f64, f64)> = points.iter().map(|(_, x, y)| (*x, *y)).collect();
    chart::svg(&Plot {
        x: name,
        y: "measured",
        points: &values,
        order: None,
        bound: outcomes[0].bound,
    })
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "passed",
        Verdict::Failed => "failed",
        Verdict::NotRun => "not_run",
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "ok",
        Verdict::Failed => "FAILED",
        Verdict::NotRun => "not run",
    }
}
