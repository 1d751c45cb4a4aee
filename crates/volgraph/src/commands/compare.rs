//! `volgraph compare`: how two pictures differ, in numbers.

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use serde_json::json;
use volgraph::{Finding, Findings, Picture, Place};
use volgraph_measure::{Comparison, ScalarDifference, compare};

use super::{errors, verify};
use crate::args::CompareArgs;
use crate::output;

pub fn run(args: &CompareArgs) -> anyhow::Result<ExitCode> {
    let mut findings = Findings::new();
    let mut load =
        |path: &Path| findings.take(Picture::load(path).map_err(|e| errors::of_picture(&e, path)));
    let a = load(&args.a);
    // A file of that name is a picture all the same.
    let is_reference = args.b == Path::new("reference") && !args.b.exists();
    let b = match &a {
        Some(a) if is_reference => Some(verify::recorded_truth(a, &args.a)?),
        _ if is_reference => None,
        _ => load(&args.b),
    };
    let (Some(a), Some(b)) = (a, b) else {
        return Err(findings.into());
    };
    let comparison = compare(&a, &b)
        .map_err(|error| Findings::from(errors::of_comparison(&error, &args.a, &args.b)))?;
    if args.json {
        output::print_json(&json!(comparison));
    } else {
        output::print(&text(&comparison));
    }
    let findings = exceeded(args, &comparison);
    if findings.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    output::report(&findings);
    Ok(ExitCode::from(1))
}

/// A finding for each bound that the pictures pass.
fn exceeded(args: &CompareArgs, comparison: &Comparison) -> Findings {
    let bounds = [
        (
            "over-max-rmse",
            "root mean square error",
            comparison.rmse,
            args.max_rmse,
        ),
        (
            "over-max-error",
            "largest error",
            comparison.max.error,
            args.max_error,
        ),
    ];
    bounds
        .into_iter()
        .filter_map(|(code, what, found, bound)| {
            let bound = bound.filter(|bound| found > *bound)?;
            let message = format!("the {what} is {found:.6e}, over the bound {bound:.6e}");
            Some(
                Finding::error(code, message)
                    .at(Place::whole_file(&args.a))
                    .related(Place::whole_file(&args.b), "the other picture"),
            )
        })
        .collect()
}

fn text(comparison: &Comparison) -> String {
    let Comparison {
        rmse,
        max,
        p999,
        psnr_db,
        mean_error,
        flip,
        depth,
        opacity,
        layers,
    } = comparison;
    let mut text = format!(
        "rmse          {rmse:.6e}  ({:.3}/255)\n\
         maximum       {:.6e}  ({:.3}/255), {:?} at ({}, {})\n\
         99.9th pct    {p999:.6e}  ({:.3}/255)\n\
         psnr          {psnr_db:.2} dB\n\
         mean error    {:.3e} {:.3e} {:.3e} {:.3e}\n",
        rmse * 255.0,
        max.error,
        max.error * 255.0,
        max.channel,
        max.x,
        max.y,
        p999 * 255.0,
        mean_error[0],
        mean_error[1],
        mean_error[2],
        mean_error[3],
    );
    // Writing to a String does not fail.
    let _ = match flip {
        Some(flip) => writeln!(text, "flip          {flip:.6}"),
        None => writeln!(text, "flip          not taken: the picture is too large"),
    };
    let own = [("depth", depth.as_ref()), ("opacity", opacity.as_ref())];
    let named = layers
        .iter()
        .map(|(name, layer)| (name.as_str(), Some(layer)));
    for (name, layer) in own.into_iter().chain(named) {
        if let Some(ScalarDifference {
            compared,
            one_sided,
            rmse,
            max,
            p999,
            ..
        }) = layer
        {
            let max = max.map_or(0.0, |max| max.error);
            let _ = writeln!(
                text,
                "{name:<13} rmse {rmse:.6e}, maximum {max:.6e}, 99.9th pct {p999:.6e}, {compared} pixels; \
                 {one_sided} only in one of the two"
            );
        }
    }
    text
}
