//! The page of `volgraph stress`: each breaking point with its pictures, error maps and curves.

use std::path::Path;

use maud::{Markup, PreEscaped, html};
use volgraph::stress::{CaseReport, MethodReport, Pixels, Verdict};
use volgraph::{Finding, Findings, Picture};
use volgraph_picture::SaveOptions;

use super::curve;
use crate::commands::html::Page;
use crate::commands::{drawing, errors, write};

const STYLE: &str = "
    body { margin: 2rem auto; max-width: 78rem; padding: 0 1rem; }
    a { color: #8fb8e8; }
    section { background: #1f2226; border-radius: 6px; padding: 1rem 1.4rem; margin: 1.2rem 0; }
    p { margin: .3rem 0 .8rem; }
    table { border-collapse: collapse; margin: .4rem 0; }
    th, td { text-align: left; padding: .15rem 1.2rem .15rem 0; vertical-align: top; }
    th { font-weight: 600; color: #93a0ad; }
    .top { display: flex; gap: 1.5rem; align-items: flex-start; }
    .top table { flex: 1; font-size: 13.5px; }
    .pictures { display: flex; flex-wrap: wrap; gap: .8rem; margin: .8rem 0 .2rem; }
    figure { margin: 0; width: 9rem; }
    figure img { display: block; width: 9rem; height: 9rem; image-rendering: pixelated; background: #000; }
    figcaption { font-size: 12.5px; color: #b8c0c8; }
    .holds { color: #7fd19a; } .fails { color: #e8b84a; } .broken { color: #ff6b5e; font-weight: 700; }
    .why { color: #93a0ad; }
    .key { display: inline-block; width: .7rem; height: .7rem; border-radius: 50%; margin-right: .4rem; }
";

/// Writes the page and its pictures into a folder.
pub fn write(
    folder: &Path,
    reports: &[CaseReport],
    adapter: &str,
    seconds: f64,
) -> Result<(), Findings> {
    write::folder(folder)?;
    for report in reports {
        pictures(folder, report)?;
    }
    let text = page(reports, adapter, seconds)?;
    write::whole(&folder.join("index.html"), text)
}

fn page(reports: &[CaseReport], adapter: &str, seconds: f64) -> Result<String, Findings> {
    let sections: Result<Vec<Markup>, Finding> = reports.iter().map(section).collect();
    let body = html! {
        h1 { "Breaking points of volume rendering" }
        p { (reports.len()) @if reports.len() == 1 { " breaking point, in " } @else { " breaking points, in " } (format!("{seconds:.0}")) " s. Each is swept; \
            pictures are of the point where a method is worst, beside the truth there. Error maps are \
            logarithmic: black at a hundredth of the bound, blue below it, yellow to red up to a hundred times as \
            much; magenta where a value is missing or no number." }
        (summary(reports))
        @for section in sections? { (section) }
    };
    let page = Page {
        title: "volgraph: breaking points",
        style: STYLE,
        adapter,
    };
    Ok(page.around(&body))
}

/// All methods in one table.
fn summary(reports: &[CaseReport]) -> Markup {
    html! {
        section {
            table {
                tr { th { "breaking point" } th { "breaks" } th { "holds" } th { "measured only" } }
                @for report in reports {
                    tr {
                        td { a href={ "#" (report.name) } { (report.name) } }
                        @for verdicts in [
                            &[Verdict::FailsAsKnown, Verdict::Broken][..],
                            &[Verdict::Holds, Verdict::HoldsNow][..],
                            &[Verdict::Reported][..],
                        ] {
                            td {
                                @for method in report.methods.iter().filter(|it| verdicts.contains(&it.verdict)) {
                                    div class=(class(method.verdict)) { (method.name)
                                        @if method.verdict == Verdict::Broken { " (must hold)" }
                                        @if method.verdict == Verdict::HoldsNow { " (holds now)" }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds | Verdict::HoldsNow => "holds",
        Verdict::Broken => "broken",
        Verdict::FailsAsKnown => "fails",
        Verdict::Reported => "why",
    }
}

fn section(report: &CaseReport) -> Result<Markup, Finding> {
    let curve = curve::svg(report)?;
    let shown = report.shown();
    Ok(html! {
        section id=(report.name) {
            h2 { (report.name) }
            p { (report.breaks) }
            div class="top" {
                div { (PreEscaped(curve)) }
                table {
                    tr { th { "method" } th { "" } th { "worst" } th { "bound" } th { "at" } }
                    @for (number, method) in report.methods.iter().enumerate() {
                        (row(report, number, method))
                    }
                }
            }
            @for (methods, why) in reasons(report) {
                p class="why" { "Bound" @if !methods.is_empty() { " of " (methods) } ": " (why) "." }
            }
            div class="pictures" {
                figure {
                    img src=(file(report, "truth", None)) alt="the truth";
                    figcaption { "truth at " (report.labels[shown]) }
                }
                @for (number, method) in report.methods.iter().enumerate() {
                    @if method.pixels[shown].is_some() {
                        figure {
                            img src=(file(report, "drawn", Some(number))) alt=(method.name);
                            figcaption { (method.name) }
                        }
                        figure {
                            img src=(file(report, "error", Some(number))) alt={ "error of " (method.name) };
                            figcaption { "its error: " (method.points[shown].words()) }
                        }
                    }
                }
            }
            details {
                summary { "the numbers, and the last graph" }
                table {
                    tr { th { (report.swept) } @for method in &report.methods { th { (method.name) } } }
                    @for (at, label) in report.labels.iter().enumerate() {
                        tr {
                            td { (label) }
                            @for method in &report.methods { td { (method.points[at].words()) } }
                        }
                    }
                }
                @if let Some(graph) = report.graphs.last() { pre { (graph) } }
            }
        }
    })
}

/// The reasons for bounds, each once: the methods that it is of, none where it is of all.
fn reasons(report: &CaseReport) -> Vec<(String, &'static str)> {
    let mut reasons: Vec<(Vec<&str>, &'static str)> = Vec::new();
    for method in &report.methods {
        match reasons.iter_mut().find(|(_, why)| *why == method.why) {
            Some((methods, _)) => methods.push(&method.name),
            None => reasons.push((vec![&method.name], method.why)),
        }
    }
    let is_one = reasons.len() == 1;
    let named = |(methods, why): (Vec<&str>, &'static str)| {
        let methods = if is_one {
            String::new()
        } else {
            methods.join(", ")
        };
        (methods, why)
    };
    reasons.into_iter().map(named).collect()
}

fn row(report: &CaseReport, number: usize, method: &MethodReport) -> Markup {
    let worst = method.worst();
    html! {
        tr {
            td { span class="key" style={ "background:" (drawing::css(number)) } {} (method.name) }
            td class=(class(method.verdict)) { (method.verdict.words()) }
            td { (worst.words()) }
            td class="why" { @if worst.bound.is_finite() { (format!("{:.1e}", worst.bound)) } }
            td { (report.labels[method.worst]) }
        }
    }
}

fn file(report: &CaseReport, what: &str, method: Option<usize>) -> String {
    match method {
        Some(number) => format!("{}_{number}_{what}.png", report.name),
        None => format!("{}_{what}.png", report.name),
    }
}

fn pictures(folder: &Path, report: &CaseReport) -> Result<(), Findings> {
    let shown = report.shown();
    let truth = &report.truth[shown];
    let look = Look::of(truth, report.unit);
    save(
        folder,
        &file(report, "truth", None),
        truth.size,
        look.picture(truth),
    )?;
    for (number, method) in report.methods.iter().enumerate() {
        let Some(drawn) = &method.pixels[shown] else {
            continue;
        };
        let name = file(report, "drawn", Some(number));
        save(folder, &name, drawn.size, look.picture(drawn))?;
        let bound = method.points[shown].bound;
        let bound = if bound.is_finite() { bound } else { 1e-2 };
        let errors = drawn
            .values
            .iter()
            .zip(&truth.values)
            .map(|pair| match pair {
                (Some(value), Some(truth)) => error_color(*value, *truth, bound),
                _ => [0.03, 0.03, 0.03, 1.0],
            });
        save(
            folder,
            &file(report, "error", Some(number)),
            drawn.size,
            errors.collect(),
        )?;
    }
    Ok(())
}

fn save(
    folder: &Path,
    name: &str,
    [width, height]: [u32; 2],
    color: Vec<[f32; 4]>,
) -> Result<(), Findings> {
    let path = folder.join(name);
    let picture = Picture::from_color(width, height, color);
    let saved = picture.and_then(|picture| picture.save(&path, SaveOptions::default()));
    // What is no number is drawn as such on purpose.
    saved
        .map(|_| ())
        .map_err(|error| errors::of_picture(&error, &path).into())
}

/// How values become colours.
enum Look {
    Color,
    Normal,
    /// Near is bright, from the nearest to the farthest of the truth.
    Depth {
        near: f64,
        far: f64,
    },
}

impl Look {
    fn of(truth: &Pixels, unit: &str) -> Self {
        match unit {
            "voxels" => {
                let depths = truth.values.iter().flatten().map(|value| value[0]);
                let (near, far) = depths
                    .filter(|depth| depth.is_finite())
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(near, far), depth| {
                        (near.min(depth), far.max(depth))
                    });
                Self::Depth { near, far }
            }
            "of a unit vector" => Self::Normal,
            _ => Self::Color,
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "pictures hold f32")]
    fn picture(&self, pixels: &Pixels) -> Vec<[f32; 4]> {
        let color = |value: &Option<[f64; 4]>| {
            let Some(value) = value else {
                return [0.03, 0.03, 0.03, 1.0];
            };
            match self {
                Self::Color => value.map(|number| number as f32),
                Self::Normal => {
                    let [x, y, z, _] = value.map(|number| (0.5 + 0.5 * number) as f32);
                    [x, y, z, 1.0]
                }
                Self::Depth { .. } if !value[0].is_finite() => [0.0, 0.0, 0.0, 1.0],
                Self::Depth { near, far } => {
                    let bright =
                        0.9 - 0.8 * ((value[0] - near) / (far - near).max(1e-9)).clamp(0.0, 1.0);
                    [bright as f32, bright as f32, bright as f32, 1.0]
                }
            }
        };
        pixels.values.iter().map(color).collect()
    }
}

/// Black at a hundredth of the bound, blue up to it, yellow to red from it to a hundred times as much.
fn error_color(value: [f64; 4], truth: [f64; 4], bound: f64) -> [f32; 4] {
    let error = (0..4)
        .map(|i| (value[i] - truth[i]).abs())
        .fold(0.0, f64::max);
    if value[0] == truth[0] && value[0] == f64::INFINITY {
        return [0.0, 0.0, 0.0, 1.0];
    }
    if !error.is_finite() || value.iter().any(|number| number.is_nan()) {
        return [1.0, 0.0, 1.0, 1.0];
    }
    #[expect(clippy::cast_possible_truncation, reason = "a colour")]
    let share = ((error / bound).max(1e-9).log10() / 2.0).clamp(-1.0, 1.0) as f32;
    if share <= 0.0 {
        let blue = 1.0 + share;
        [0.05 * blue, 0.2 * blue, 0.5 * blue, 1.0]
    } else {
        [1.0, 0.75 * (1.0 - share), 0.0, 1.0]
    }
}
