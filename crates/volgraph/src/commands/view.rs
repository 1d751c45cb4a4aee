//! `volgraph view`: the live window.

use std::process::ExitCode;
use std::time::Duration;

use volgraph_viewer::{Measured, WorkerOptions};

use crate::args::ViewArgs;
use crate::output;

pub fn run(args: &ViewArgs) -> anyhow::Result<ExitCode> {
    let options = WorkerOptions {
        graph: args.scene.graph.clone(),
        session: super::session_options(&args.scene, None),
        budget: args.budget.map(|ms| Duration::from_millis(ms.into())),
    };
    let Some(seconds) = args.measure else {
        volgraph_viewer::open(options)?;
        return Ok(ExitCode::SUCCESS);
    };
    let measured = volgraph_viewer::measure(options, Duration::from_secs(seconds.into()))?;
    let [width, height] = measured.moving;
    let row = |name: &str, rising: &[f64]| {
        let at = |share| Measured::quantile(rising, share);
        let (low, middle, high) = (at(0.1), at(0.5), at(0.9));
        format!("{name:<28}{middle:>8.1} ms  (10 % {low:.1}, 90 % {high:.1})")
    };
    output::print(&format!(
        "{} pictures of {width}x{height} while moving\n{}\n{}\n{}",
        measured.between_ms.len(),
        row("from picture to picture", &measured.between_ms),
        row("drawing a picture", &measured.drawing_ms),
        row("the interface's own work", &measured.interface_ms),
    ));
    Ok(ExitCode::SUCCESS)
}
