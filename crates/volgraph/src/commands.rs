//! The commands, one file each.

mod adapters;
mod bench;
mod check;
mod compare;
mod errors;
mod graphs;
mod info;
mod new;
mod nodes;
mod plan;
mod render;
mod test;
mod write;

use std::process::ExitCode;

use volgraph::{Scene, registry};
use volgraph_graph::is_embedded;

use crate::args::{Command, SceneArgs};
use crate::output;
use crate::progress::Bars;

/// Runs a command.
pub fn run(command: Command) -> anyhow::Result<ExitCode> {
    match command {
        Command::Render(args) => render::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Nodes(args) => nodes::run(&args),
        Command::New(args) => new::run(&args),
        Command::Test(args) => test::run(&args),
        Command::Graphs(args) => graphs::run(&args),
        Command::Adapters(args) => adapters::run(&args),
        Command::Bench(args) => bench::run(&args),
    }
}

/// Loads a scene with a progress bar and tells its warnings.
fn load(args: &SceneArgs) -> anyhow::Result<Scene> {
    let bars = Bars::new();
    let loaded = Scene::load(
        &args.graph,
        &args.overrides(),
        &args.shader_folders(),
        registry(),
        &bars,
    );
    bars.clear();
    let scene = loaded?;
    if scene.path != args.graph && is_embedded(&scene.path) {
        output::note(&format!(
            "there is no file {} here; this is volgraph's own {}",
            args.graph.display(),
            scene.path.display()
        ));
    }
    for (source, warning) in scene.warnings() {
        output::warn(&format!("source {source}: {warning}"));
    }
    Ok(scene)
}
