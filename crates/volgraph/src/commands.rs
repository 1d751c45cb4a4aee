//! The commands, one file each.

mod adapters;
mod bench;
mod check;
mod compare;
mod errors;
mod graphs;
mod info;
mod link;
mod new;
mod nodes;
mod plan;
mod render;
mod shader_tree;
mod test;
mod watch;
mod write;

use std::path::Path;
use std::process::ExitCode;

use volgraph::{Findings, Scene, SessionOptions, registry};
use volgraph_graph::is_embedded;
use volgraph_picture::{PictureError, PngBits};

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
        Command::New(args) => new::run(&args),
        Command::Test(args) => test::run(&args),
        Command::Graphs(args) => graphs::run(&args),
        Command::Adapters(args) => adapters::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Watch(args) => watch::run(&args),
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

/// How a session for these arguments is opened; pictures carry depth and opacity where their file can.
fn session_options(args: &SceneArgs, output: Option<&Path>) -> SessionOptions {
    SessionOptions {
        adapter: args.adapter_choice(),
        size: args.size,
        overrides: args.overrides(),
        shader_folders: args.shader_folders(),
        with_layers: output.is_some_and(|output| extension(output) == "exr"),
        max_resource_bytes: args.max_resource_gib.map(|gib| gib << 30),
    }
}

fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

/// Refuses a name that no picture can be saved to, before anything else is done.
fn check_extension(output: &Path) -> Result<(), Findings> {
    if ["png", "exr"].contains(&extension(output).as_str()) {
        return Ok(());
    }
    let error = PictureError::Extension {
        path: output.to_path_buf(),
    };
    Err(errors::of_picture(&error, output).into())
}

/// `--png-bits`, which clap has checked.
fn png_bits(bits: &str) -> PngBits {
    if bits == "16" {
        PngBits::Sixteen
    } else {
        PngBits::Eight
    }
}
