//! The commands, one file each.

mod adapters;
mod bench;
mod check;
mod compare;
mod errors;
mod info;
mod link;
mod nodes;
mod plan;
mod render;
mod shader_tree;

use std::process::ExitCode;

use volgraph::{Scene, registry};

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
        Command::Link(args) => link::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Nodes(args) => nodes::run(&args),
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
    for (source, warning) in scene.warnings() {
        output::warn(&format!("source {source}: {warning}"));
    }
    Ok(scene)
}
