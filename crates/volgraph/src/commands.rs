//! The commands, one file each.

mod adapters;
mod advise;
mod animate;
mod bench;
mod chart;
mod check;
mod compare;
mod convert;
mod distance_field;
mod drawing;
mod errors;
mod gallery;
mod graphs;
mod html;
mod info;
mod levels;
mod link;
mod new;
mod nodes;
mod plan;
mod pyramid;
mod ray;
mod reference;
mod render;
mod set;
mod shader_tree;
mod software;
mod stress;
mod test;
mod transfer;
mod verify;
mod view;
mod watch;
mod write;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use volgraph::truth::default_cache;
use volgraph::{Finding, Findings, Place, Scene, SessionOptions, alone, registry};
use volgraph_graph::is_embedded;
use volgraph_picture::{PictureError, PngBits};
use volgraph_volume::VolumeError;

use crate::args::{Command, SceneArgs};
use crate::output;
use crate::progress::Bars;

/// Runs a command.
pub fn run(command: Command) -> anyhow::Result<ExitCode> {
    match command {
        Command::Render(args) => render::run(&args),
        Command::Animate(args) => animate::run(&args),
        Command::Reference(args) => reference::run(&args),
        Command::Advise(args) => advise::run(&args),
        Command::Stress(args) => stress::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Ray(args) => ray::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Convert(args) => convert::run(&args),
        Command::Pyramid(args) => pyramid::run(&args),
        Command::Levels(args) => levels::run(&args),
        Command::DistanceField(args) => distance_field::run(&args),
        Command::Link(args) => link::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Nodes(args) => nodes::run(&args),
        Command::New(args) => new::run(&args),
        Command::Test(args) => test::run(&args),
        Command::Graphs(args) => graphs::run(&args),
        Command::Set(args) => set::run(&args),
        Command::Transfer(args) => transfer::run(&args),
        Command::Gallery(args) => gallery::run(&args),
        Command::Adapters(args) => adapters::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Chart(args) => chart::run(&args),
        Command::Watch(args) => watch::run(&args),
        Command::View(args) => view::run(&args),
    }
}

/// An error about a volume as what commands return.
fn volume_error(error: VolumeError) -> anyhow::Error {
    Findings::from(Finding::from(error)).into()
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
    tell_warnings(args, &scene);
    Ok(scene)
}

/// Tells whose graph it is, and what the user should know of its sources.
fn tell_warnings(args: &SceneArgs, scene: &Scene) {
    let volume = alone::volume_of(&scene.path);
    if let Some(Ok(picked)) = volume.as_ref().map(|volume| alone::graph_for(volume)) {
        output::note(&format!(
            "{} is a volume: {}; `volgraph graphs --for {0} -o FILE.ron` saves the graph",
            args.graph.display(),
            picked.why
        ));
    } else if scene.path != args.graph && is_embedded(&scene.path) {
        output::note(&format!(
            "there is no file {} here; this is volgraph's own {}",
            args.graph.display(),
            scene.path.display()
        ));
    }
    for (source, warning) in scene.warnings() {
        output::warn(&format!("source {source}: {warning}"));
    }
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
        is_as_written: false,
        cache: default_cache(),
    }
}

fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

/// Refuses a name that no picture can be saved to, before anything else is done.
fn check_output(output: &Path) -> Result<(), Findings> {
    let path = output.to_path_buf();
    let folder = folder_of(output);
    let refused = |why: String| PictureError::Io {
        path: path.clone(),
        source: std::io::Error::other(why),
    };
    let error = if !["png", "exr"].contains(&extension(output).as_str()) {
        PictureError::Extension { path }
    } else if output.is_dir() {
        refused("it is a folder".to_owned())
    } else if !folder.is_dir() {
        refused(format!("there is no folder {}", folder.display()))
    } else {
        return Ok(());
    };
    Err(errors::of_picture(&error, output).into())
}

/// Refuses a picture that would take the place of a file that it is made of.
fn check_overwrites<'p>(
    output: &Path,
    inputs: impl IntoIterator<Item = &'p Path>,
) -> Result<(), Findings> {
    let entry = |path: &Path| {
        let folder = folder_of(path).canonicalize().ok()?;
        Some(folder.join(path.file_name()?))
    };
    // Both what the names stand for and what links lead to: saving replaces the one, and readers follow the other.
    let of = |path: &Path| [entry(path), path.canonicalize().ok()];
    let taken: Vec<PathBuf> = of(output).into_iter().flatten().collect();
    let is_output = |input: &Path| {
        of(input)
            .into_iter()
            .flatten()
            .any(|it| taken.contains(&it))
    };
    let Some(input) = inputs.into_iter().find(|input| is_output(input)) else {
        return Ok(());
    };
    let message = format!(
        "the picture would replace {}, which is read for it",
        input.display()
    );
    Err(Finding::error(OVERWRITES, message)
        .at(Place::whole_file(output))
        .help("save the picture under another name")
        .into())
}

/// What [`check_overwrites`] finds.
const OVERWRITES: &str = "overwrites-input";

/// The folder of a file; the current one for a bare name.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// `--png-bits`, which clap has checked.
fn png_bits(bits: &str) -> PngBits {
    if bits == "16" {
        PngBits::Sixteen
    } else {
        PngBits::Eight
    }
}
