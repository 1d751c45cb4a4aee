//! `volgraph reference`: what a graph's picture should be, in float64 on the processor.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use serde_json::json;
use volgraph::truth::plan_without_device;
use volgraph::{Findings, Truth};
use volgraph_picture::SaveOptions;
use volgraph_reference::Progress;

use super::{check_output, check_overwrites, errors, load};
use crate::args::ReferenceArgs;
use crate::output;
use crate::progress::Bars;

/// Rows as a bar.
pub struct Rows<'a>(pub &'a Bars);

impl Progress for Rows<'_> {
    fn rows(&self, done: usize, total: usize) -> bool {
        self.0
            .count("computing the reference", done as u64, total as u64);
        true
    }
}

pub fn run(args: &ReferenceArgs) -> anyhow::Result<ExitCode> {
    check_output(&args.output)?;
    let start = Instant::now();
    let scene = load(&args.scene)?;
    let inputs = scene.data.keys().chain([&scene.path]);
    check_overwrites(&args.output, inputs.map(PathBuf::as_path))?;
    let plan = plan_without_device(&scene, args.scene.size)?;
    let bars = Bars::new();
    let truth = Truth::of(&plan, &plan.view(), &args.truth.options(), &Rows(&bars));
    bars.clear();
    let truth = truth?;
    let _saved = truth
        .picture()?
        .save(&args.output, SaveOptions::default())
        .map_err(|error| Findings::from(errors::of_picture(&error, &args.output)))?;
    let bound = truth.rendered.error.iter().copied().fold(0.0, f64::max);
    let seconds = start.elapsed().as_secs_f64();
    if args.json {
        output::print_json(&json!({
            "output": args.output.display().to_string(),
            "size": args.scene.size,
            "tolerance": truth.tolerance,
            "error_bound": bound,
            "is_cached": truth.is_cached,
            "digest": truth.digest,
            "total_s": seconds,
        }));
    } else {
        let [width, height] = args.scene.size;
        let kept = if truth.is_cached {
            ", kept from before"
        } else {
            ""
        };
        output::print(&format!(
            "{} {width}x{height} in {seconds:.1} s, each pixel within {bound:.1e}{kept}",
            args.output.display()
        ));
    }
    Ok(ExitCode::SUCCESS)
}
