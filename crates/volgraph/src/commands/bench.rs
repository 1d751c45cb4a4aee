//! `volgraph bench`: frame times of one graph, or a report of all techniques.
//!
//! [`one`] times a graph beside its limit. A report is made step by step ([`tables`], [`growth`], [`start_up`],
//! [`peers`]); after each step it is written again as bench.json and as a page ([`page`]), so that nothing measured is
//! lost where it is interrupted.

mod edits;
mod growth;
mod one;
mod page;
mod peer_chart;
mod peer_methods;
mod peers;
mod report;
mod start_up;
mod tables;
#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use volgraph::bench::{Technique, own_technique};
use volgraph::{Finding, Findings, SessionOptions};
use volgraph_gpu::Gpu;

pub use self::one::memory;
use self::report::{Report, Writer};
use super::session_options;
use crate::args::{BenchArgs, SceneArgs};
use crate::output;
use crate::progress::Bars;

pub fn run(args: &BenchArgs) -> anyhow::Result<ExitCode> {
    if args.list {
        for technique in Technique::all() {
            output::print(&format!("{:<24} {}", technique.name, technique.doc));
        }
        return Ok(ExitCode::SUCCESS);
    }
    match (&args.output, args.graphs.as_slice()) {
        (Some(folder), _) if args.is_report() => {
            let scene = args.report_scene();
            let options = session_options(&scene, None);
            let gpu = Arc::new(Gpu::open(&options.adapter)?);
            let bench = Bench {
                args,
                options,
                gpu: Arc::clone(&gpu),
                bars: Bars::new(),
            };
            let mut writer = Writer::new(folder, Report::new(gpu.adapter().clone()))?;
            bench.report(&mut writer)?;
            bench.bars.clear();
            writer.finish(args.json)?;
            Ok(ExitCode::SUCCESS)
        }
        (_, [_]) if args.size.len() > 1 => Err(Findings::from(
            Finding::error("bench-sizes", "one graph is timed at one size")
                .help("give one `--size`; or add --tables -o FOLDER to compare several"),
        )
        .into()),
        (_, [graph]) => one::run(args, &scene_args(args, graph.clone())?),
        _ => Err(Findings::from(
            Finding::error("bench-graphs", "one graph is timed at a time")
                .help("name one graph; or add --tables -o FOLDER to compare several"),
        )
        .into()),
    }
}

fn scene_args(args: &BenchArgs, graph: PathBuf) -> Result<SceneArgs, Findings> {
    let refused = |why: String| Findings::from(Finding::error("bench-volume", why));
    args.scene(graph).map_err(refused)
}

/// What all steps share.
struct Bench<'a> {
    args: &'a BenchArgs,
    options: SessionOptions,
    gpu: Arc<Gpu>,
    bars: Bars,
}

impl Bench<'_> {
    fn report(&self, writer: &mut Writer) -> Result<(), Findings> {
        if self.args.start_up {
            start_up::run(self, writer)?;
        }
        if self.args.tables {
            tables::run(self, writer)?;
        }
        if self.args.growth {
            growth::run(self, writer)?;
        }
        if let Some(folder) = &self.args.peers {
            peers::run(self, folder, writer)?;
        }
        Ok(())
    }

    /// The techniques that are asked for: graphs of the user's own, or the ready ones.
    fn techniques(&self, ready: &[&str]) -> Result<Vec<Technique>, Findings> {
        let mut all: Vec<Technique> = if self.args.graphs.is_empty() {
            let is_ready = |technique: &Technique| {
                ready.is_empty()
                    || !self.args.filter.is_empty()
                    || ready.contains(&technique.name.as_str())
            };
            Technique::all().into_iter().filter(is_ready).collect()
        } else {
            self.args
                .graphs
                .iter()
                .map(|graph| own_technique(graph))
                .collect()
        };
        all.retain(|technique| self.args.is_wanted(&technique.name));
        if all.is_empty() {
            let finding = Finding::error("no-technique", "no technique has that text in its name");
            return Err(finding.help("`volgraph bench --list` lists them").into());
        }
        Ok(all)
    }
}
