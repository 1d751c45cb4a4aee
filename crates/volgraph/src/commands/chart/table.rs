//! All measurements of a graph as comma separated values, a row for each method; of those that were refused the reason.

use volgraph::methods::Method;
use volgraph::renderer::{DEVICE, RENDERER};
use volgraph::{Finding, Findings};

use super::exhibit::Exhibit;

/// The columns after those of the settings.
const FIGURES: [&str; 19] = [
    "front",
    "refined",
    "steady_ms",
    "median_ms",
    "min_ms",
    "max_ms",
    "frames",
    "ratio_median",
    "ratio_min",
    "ratio_max",
    "rmse",
    "max",
    "p99.9",
    "core_rmse",
    "rmse_8bit",
    "core_rmse_8bit",
    "core_rmse_steps",
    "core_rmse_8bit_steps",
    "refused",
];

/// The table's text.
pub fn csv(exhibit: &Exhibit) -> Result<String, Findings> {
    rows(exhibit).map_err(|error| Finding::error("chart-table", error.to_string()).into())
}

/// A method's settings; the renderer in words.
fn settings(axes: &[&str], method: &Method) -> Vec<String> {
    let value = |axis: &&str| match method.text(axis) {
        text if *axis == RENDERER && text.is_empty() => DEVICE.to_owned(),
        text => text,
    };
    axes.iter().map(value).collect()
}

fn rows(exhibit: &Exhibit) -> Result<String, Box<dyn std::error::Error>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let axes = exhibit.columns();
    table.write_record(axes.iter().copied().chain(FIGURES))?;
    for measured in &exhibit.survey.measured {
        let mut row = settings(&axes, &measured.method);
        row.push(u8::from(measured.is_front).to_string());
        row.push(u8::from(measured.is_refined).to_string());
        let (time, ratio) = (&measured.time_ms, &measured.ratio);
        let times = [measured.steady_ms, time.median, time.min, time.max];
        row.extend(times.map(|ms| format!("{ms:.4}")));
        row.push(time.n.to_string());
        row.extend([ratio.median, ratio.min, ratio.max].map(|ratio| format!("{ratio:.5}")));
        let errors = &measured.errors;
        let figures = [
            errors.rmse,
            errors.max,
            errors.p999,
            errors.core_rmse,
            errors.rmse_8bit,
            errors.core_rmse_8bit,
            errors.core_rmse * 255.0,
            errors.core_rmse_8bit * 255.0,
        ];
        row.extend(figures.map(|error| format!("{error:.6e}")));
        row.push(String::new());
        table.write_record(row)?;
    }
    for (method, why) in &exhibit.survey.refused {
        let mut row = settings(&axes, method);
        row.extend(FIGURES[1..].iter().map(|_| String::new()));
        row.push(why.clone());
        table.write_record(row)?;
    }
    Ok(String::from_utf8(table.into_inner()?)?)
}
