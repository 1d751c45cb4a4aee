//! What a graph's picture may cost, or how wrong it may be: `quality: budget(rmse: 0.002)`.

use serde::Serialize;
use volgraph_report::ron_text::{Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

/// A budget, of which only one side can be given: the other is what is then made as good as it can be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Budget {
    /// The root mean square error of linear premultiplied colours that is still taken; the fastest method is chosen.
    Rmse(f64),
    /// The milliseconds that a frame may take; the most accurate method is chosen.
    TimeMs(f64),
}

/// The field `quality` of a graph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QualityDesc {
    /// The budget.
    pub budget: Budget,
    /// Where it is written.
    pub place: Place,
}

/// Reads `budget(rmse: …)` or `budget(time_ms: …)`.
///
/// # Errors
/// All findings, each with its place.
pub fn quality(value: &Value<'_>) -> Result<QualityDesc, Findings> {
    let (name, entries) = value.variant()?;
    if name != "budget" {
        return Err(value
            .error("unknown-quality", format!("unknown quality `{name}`"))
            .help_opt(did_you_mean(&name, ["budget"]))
            .into());
    }
    let mut findings = Findings::new();
    let mut fields = Fields::new(entries);
    let rmse = fields.read(&mut findings, "rmse", |value| {
        within(value, 1e-6, 1.0, "an error")
    });
    let time_ms = fields.read(&mut findings, "time_ms", |value| {
        within(value, 1e-3, 1e6, "a time in milliseconds")
    });
    fields.finish(&mut findings);
    let budget = match (rmse, time_ms) {
        (Some(rmse), None) => Some(Budget::Rmse(rmse)),
        (None, Some(time)) => Some(Budget::TimeMs(time)),
        (Some(_), Some(_)) => {
            let message = "a budget has either `rmse` or `time_ms`";
            findings.push(
                value
                    .error("exclusive-fields", message)
                    .help("leave one out: it is what is then made as good as it can be"),
            );
            None
        }
        (None, None) => {
            if !findings.has_errors() {
                let finding = value.error("missing-field", "the budget is empty");
                findings.push(finding.help("write `budget(rmse: 0.002)` or `budget(time_ms: 50)`"));
            }
            None
        }
    };
    match budget {
        Some(budget) if !findings.has_errors() => Ok(QualityDesc {
            budget,
            place: value.place(),
        }),
        _ => Err(findings),
    }
}

fn within(value: &Value<'_>, least: f64, most: f64, what: &str) -> Result<f64, Finding> {
    let number = value.f64()?;
    if (least..=most).contains(&number) {
        return Ok(number);
    }
    let message = format!("{what} of {number} is not between {least} and {most}");
    Err(value.error("bad-budget", message))
}
