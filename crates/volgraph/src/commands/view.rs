//! `volgraph view`: the live window.

use std::process::ExitCode;
use std::time::Duration;

use volgraph_viewer::WorkerOptions;

use crate::args::ViewArgs;

pub fn run(args: &ViewArgs) -> anyhow::Result<ExitCode> {
    volgraph_viewer::open(WorkerOptions {
        graph: args.scene.graph.clone(),
        session: super::session_options(&args.scene, None),
        budget: args.budget.map(|ms| Duration::from_millis(ms.into())),
    })?;
    Ok(ExitCode::SUCCESS)
}
