//! `volgraph info`: a volume's dimensions, placement and statistics.

use std::fmt::Write;
use std::process::ExitCode;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use serde_json::{Value, json};
use volgraph::{Finding, Findings};
use volgraph_formats::LoadOptions;
use volgraph_volume::{Grid, Values, Volume};

use crate::args::InfoArgs;
use crate::output;
use crate::progress::Bars;

const PERCENTILES: [f64; 7] = [1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0];
const HISTOGRAM_ROWS: usize = 16;
const HISTOGRAM_COLUMNS: f64 = 40.0;

pub fn run(args: &InfoArgs) -> anyhow::Result<ExitCode> {
    let bars = Arc::new(Bars::new());
    let shown = Arc::clone(&bars);
    let what = format!("reading {}", args.volume.volume.display());
    let options = LoadOptions {
        progress: Some(Arc::new(move |done, total| {
            shown.update(&what, done, total);
        })),
        ..args.volume.options()
    };
    let loaded = volgraph_formats::load(&args.volume.volume, &options);
    bars.clear();
    let volume = loaded.map_err(|error| Findings::from(Finding::from(error)))?;
    if args.json {
        output::print_json(&to_json(&volume));
    } else {
        output::print(&text(&volume));
    }
    Ok(ExitCode::SUCCESS)
}

/// Unit world directions of the index axes, as columns.
fn directions(grid: &Grid) -> DMat3 {
    let spacing = grid.spacing();
    let axes = grid.world_from_index.matrix3;
    DMat3::from_cols(
        axes.x_axis / spacing.x,
        axes.y_axis / spacing.y,
        axes.z_axis / spacing.z,
    )
}

/// The world axes that the index axes run along, such as `+x -y +z`; `None` where one runs between them.
fn along(directions: DMat3) -> Option<String> {
    let name = |direction: DVec3| {
        let (axis, length) = direction
            .abs()
            .to_array()
            .into_iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        let sign = if direction[axis] < 0.0 { '-' } else { '+' };
        (length > 1.0 - 1e-9).then(|| format!("{sign}{}", ["x", "y", "z"][axis]))
    };
    let names: Option<Vec<String>> = [directions.x_axis, directions.y_axis, directions.z_axis]
        .into_iter()
        .map(name)
        .collect();
    Some(names?.join(" "))
}

fn text(volume: &Volume) -> String {
    let grid = volume.grid();
    let statistics = volume.statistics();
    let [x, y, z] = grid.dims;
    let triple = |v: DVec3| format!("{} {} {}", v.x, v.y, v.z);
    let directions = directions(grid);
    let about = volume.about();
    let after = |unit: &Option<String>| unit.as_ref().map(|unit| format!(" {unit}"));
    let unit = after(&about.length_unit).unwrap_or_default();
    let mut out = format!("format       {}\n", about.format);
    let _ = write!(
        out,
        "name         {}\ndims         {x} x {y} x {z}, {} voxels\ntype         {}\nspacing      {}{unit}\norigin       {}{unit}\n",
        volume.name(),
        grid.voxel_count(),
        volume.voxels().scalar_type().name(),
        triple(grid.spacing()),
        triple(grid.origin()),
    );
    // Writing to a String does not fail.
    let _ = match along(directions) {
        Some(axes) => writeln!(
            out,
            "orientation  index axes along {axes} of the world (LPS)"
        ),
        None => {
            let rows = directions.transpose();
            let row = |v: DVec3| format!("{:>9.6} {:>9.6} {:>9.6}", v.x, v.y, v.z);
            writeln!(
                out,
                "orientation  oblique; unit directions of the index axes in the world (LPS), as columns:\n\
                 {:13}{}\n{:13}{}\n{:13}{}",
                "",
                row(rows.x_axis),
                "",
                row(rows.y_axis),
                "",
                row(rows.z_axis)
            )
        }
    };
    if grid.node_centred {
        out.push_str("centring     nodes: the box spans voxel centre to voxel centre\n");
    }
    out.push_str(&said(volume));
    let unit = after(&about.value_unit).unwrap_or_default();
    match statistics.range() {
        Some((low, high)) => {
            let _ = writeln!(out, "range        {low} to {high}{unit}");
            let _ = writeln!(
                out,
                "mean         {}, standard deviation {}",
                statistics.mean, statistics.standard_deviation
            );
            let percentiles = PERCENTILES.map(|p| format!("{p}%: {}", statistics.percentile(p)));
            let _ = writeln!(out, "percentiles  {}", percentiles.join(", "));
        }
        None => out.push_str("range        no voxel is finite\n"),
    }
    let _ = writeln!(
        out,
        "not finite   {} not a number, {} plus infinity, {} minus infinity",
        statistics.nan_count,
        statistics.positive_infinity_count,
        statistics.negative_infinity_count
    );
    out.push_str(&histogram(volume));
    for warning in volume.warnings() {
        let _ = writeln!(out, "warning      {warning}");
    }
    let _ = writeln!(out, "digest       {}", volume.digest());
    out
}

/// Most labels that are printed.
const LABELS: usize = 24;

/// What the file says of its values: components, time, meaning, and other facts.
fn said(volume: &Volume) -> String {
    let about = volume.about();
    let mut out = String::new();
    // Writing to a String does not fail.
    if let Some(picked) = &about.picked {
        let _ = writeln!(
            out,
            "component    {} of {} values per voxel",
            picked.component, picked.count
        );
    }
    if let Some(step) = &about.step {
        let unit = step.unit.as_deref().unwrap_or_default();
        let at = step
            .time
            .map(|time| format!(", at {time} {unit}").trim_end().to_owned());
        let _ = writeln!(
            out,
            "time step    {} of {}{}",
            step.index,
            step.count,
            at.unwrap_or_default()
        );
    }
    match &about.values {
        Values::Unknown => {}
        Values::Hounsfield => out.push_str("values       Hounsfield units\n"),
        Values::Named(name) => {
            let _ = writeln!(out, "values       {name}");
        }
        Values::Labels(names) => {
            let _ = writeln!(out, "values       labels");
            for (label, name) in names.iter().take(LABELS) {
                let _ = writeln!(out, "{label:>12} {name}");
            }
            if names.len() > LABELS {
                let _ = writeln!(out, "             and {} more", names.len() - LABELS);
            }
        }
    }
    for (name, fact) in &about.facts {
        let _ = writeln!(out, "{name:<12} {fact}");
    }
    out
}

/// A bar for each sixteenth of the range, as long as the logarithm of its count.
fn histogram(volume: &Volume) -> String {
    let histogram = volume.histogram(HISTOGRAM_ROWS);
    let most = histogram.counts.iter().copied().max().unwrap_or(0);
    if most == 0 {
        return String::new();
    }
    let mut out = "histogram    from, voxels (lengths are logarithms)\n".to_owned();
    let width = (histogram.hi - histogram.lo) / HISTOGRAM_ROWS as f64;
    let length =
        |count: u64| (count as f64 + 1.0).ln() / (most as f64 + 1.0).ln() * HISTOGRAM_COLUMNS;
    for (row, &count) in histogram.counts.iter().enumerate() {
        let from = histogram.lo + row as f64 * width;
        let bar = "#".repeat(length(count).round() as usize);
        let _ = writeln!(out, "{from:>12.6} {count:>12} {bar}");
        if width <= 0.0 {
            break;
        }
    }
    out
}

fn to_json(volume: &Volume) -> Value {
    let about = volume.about();
    let (values, labels) = match &about.values {
        Values::Unknown => (None, None),
        Values::Hounsfield => (Some("hounsfield"), None),
        Values::Named(name) => (Some(name.as_str()), None),
        Values::Labels(names) => (Some("labels"), Some(names)),
    };
    let facts: serde_json::Map<String, Value> = about
        .facts
        .iter()
        .map(|(name, fact)| (name.clone(), json!(fact)))
        .collect();
    let step = about.step.as_ref();
    let grid = volume.grid();
    let statistics = volume.statistics();
    let directions = directions(grid);
    let percentiles: serde_json::Map<String, Value> = PERCENTILES
        .iter()
        .map(|&p| (p.to_string(), json!(statistics.percentile(p))))
        .collect();
    json!({
        "name": volume.name(),
        "format": about.format,
        "files": volume.source_files(),
        "dims": grid.dims,
        "type": volume.voxels().scalar_type().name(),
        "length_unit": about.length_unit,
        "values": values,
        "labels": labels,
        "value_unit": about.value_unit,
        "component": about.picked.map(|picked| picked.component.to_string()),
        "component_count": about.picked.map_or(1, |picked| picked.count),
        "step": step.map(|step| step.index),
        "step_count": step.map_or(1, |step| step.count),
        "time": step.and_then(|step| step.time),
        "time_unit": step.and_then(|step| step.unit.as_deref()),
        "has_colors": volume.colors().is_some(),
        "facts": facts,
        "spacing": grid.spacing().to_array(),
        "origin": grid.origin().to_array(),
        "directions": directions.to_cols_array_2d(),
        "is_oblique": along(directions).is_none(),
        "node_centred": grid.node_centred,
        "min": statistics.min,
        "max": statistics.max,
        "mean": statistics.mean,
        "standard_deviation": statistics.standard_deviation,
        "percentiles": percentiles,
        "percentile_error": statistics.percentile_error(),
        "nan_count": statistics.nan_count,
        "positive_infinity_count": statistics.positive_infinity_count,
        "negative_infinity_count": statistics.negative_infinity_count,
        "histogram": {
            "from": statistics.histogram.lo,
            "to": statistics.histogram.hi,
            "counts": statistics.histogram.counts,
        },
        "warnings": volume.warnings(),
        "digest": volume.digest().to_hex(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orientations_are_named_only_where_the_axes_are_the_worlds() {
        assert_eq!(along(DMat3::IDENTITY).as_deref(), Some("+x +y +z"));
        let turned = DMat3::from_cols(DVec3::NEG_Y, DVec3::X, DVec3::NEG_Z);
        assert_eq!(along(turned).as_deref(), Some("-y +x -z"));
        assert_eq!(along(DMat3::from_rotation_z(0.01)), None);
    }
}
