//! Curves of cost as the work grows.

use std::time::Instant;

use volgraph::bench::{GrowthAxis, GrowthOptions, growth};
use volgraph::{Findings, Overrides};

use super::Bench;
use super::report::Writer;
use crate::output;

/// What is drawn where the user names no technique.
const READY: [&str; 3] = ["dvr_unlit", "mip", "isosurface"];

pub fn run(bench: &Bench<'_>, writer: &mut Writer) -> Result<(), Findings> {
    let args = bench.args;
    let techniques = bench.techniques(&READY)?;
    for technique in &techniques {
        writer.report.name(&technique.name, &technique.doc);
    }
    let mut session = bench.options.clone();
    session.overrides = Overrides::default();
    let started = Instant::now();
    let all = techniques.len() * GrowthAxis::ALL.len();
    let mut done = 0;
    for axis in GrowthAxis::ALL {
        for technique in &techniques {
            bench.bars.count("timing growth", done as u64, all as u64);
            let left = args.seconds - started.elapsed().as_secs_f64();
            let options = GrowthOptions {
                largest_view: args.largest_view,
                largest_volume: args.largest_volume,
                view: args.largest_view.min(256),
                volume: args.largest_volume.min(128),
                seconds: left.max(0.0) / (all - done) as f64,
                rounds: args.frames.unwrap_or(9),
                stage: args
                    .stage
                    .last()
                    .cloned()
                    .unwrap_or_else(|| "compute".to_owned()),
                traverse: "skip".to_owned(),
            };
            let found = growth(axis, technique, &bench.gpu, &session, &options)?;
            if !args.json {
                bench.bars.clear();
                output::print(&format!(
                    "{:<24} {:<24} {}",
                    technique.name,
                    axis.words(),
                    exponent(&found)
                ));
            }
            writer.report.growth.push(found);
            writer.write()?;
            done += 1;
        }
    }
    Ok(())
}

/// The exponent with its error, for people.
pub fn exponent(growth: &volgraph::bench::Growth) -> String {
    match growth.fit {
        Some(fit) => match fit.standard_error {
            Some(error) => format!("{:.3} ± {error:.3}", fit.exponent),
            None => format!("{:.3}", fit.exponent),
        },
        None => "-".to_owned(),
    }
}
