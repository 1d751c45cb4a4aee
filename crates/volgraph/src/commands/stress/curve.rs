//! Errors over what is swept: each method's largest error, and thin what it may be; a cross where it has holes or worse.

use volgraph::Finding;
use volgraph::stress::CaseReport;

use crate::commands::drawing::{Axis, Curve, Drawing, Mark, inline};

/// Errors below this are drawn at it.
const LEAST: f64 = 1e-9;

/// The drawing.
///
/// # Errors
/// What the drawing library refused.
pub fn svg(report: &CaseReport) -> Result<String, Finding> {
    let has_sizes = has_sizes(report);
    let place = |at: usize| {
        if has_sizes {
            report.at[at]
        } else {
            (at + 1) as f64
        }
    };
    let curves = report.methods.iter().map(|method| {
        let measured = method.points.iter().enumerate();
        let points = measured.clone().filter(|(_, it)| it.refused.is_none());
        let points = points.map(|(at, it)| {
            let is_whole = it.holes + it.phantoms + it.specks + it.non_finite == 0;
            let mark = if is_whole { Mark::Full } else { Mark::Cross };
            (place(at), it.error.max(LEAST), mark)
        });
        let bounds = measured.filter(|(_, it)| it.bound.is_finite());
        Curve {
            name: String::new(),
            points: points.collect(),
            is_joined: true,
            lines: vec![
                bounds
                    .map(|(at, it)| (place(at), it.bound.max(LEAST)))
                    .collect(),
            ],
        }
    });
    let drawing = Drawing {
        size: (460, 260),
        title: "",
        x: report.swept,
        y: &format!("error ({})", report.unit),
        axis: if has_sizes {
            Axis::values(&report.at)
        } else {
            Axis::numbers(report.at.len())
        },
        curves: curves.collect(),
    };
    Ok(inline(&drawing.svg()?))
}

/// Whether the swept numbers are sizes, and no mere names.
fn has_sizes(report: &CaseReport) -> bool {
    report.at.iter().all(|at| *at > 0.0)
        && report
            .at
            .iter()
            .zip(&report.labels)
            .all(|(at, label)| label.parse() == Ok(*at) || *label == format!("{at:e}"))
}
