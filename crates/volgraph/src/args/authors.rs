//! The arguments of the commands for authors of shaders and graphs.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use volgraph::{CameraDesc, ParamOverride};

use super::{DataArgs, EachSceneArgs, ShaderArgs, parse_camera, parse_volume};

/// `volgraph new`.
#[derive(ClapArgs, Debug)]
pub struct NewArgs {
    /// The slot that the shader is for.
    pub slot: NewSlot,
    /// The name of the shader, its graph and its test: small letters, digits and `_`.
    pub name: String,
    /// The folder to write into.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub folder: PathBuf,
}

/// The slots that there are templates for.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum NewSlot {
    /// What does a segment add to the pixel?
    Technique,
    /// What are colour and opacity of a segment?
    Classify,
    /// How is a point lit?
    Light,
    /// Where does the next segment end?
    Traverse,
    /// What is the scalar at a point?
    Reconstruct,
    /// What is the gradient at a point?
    Gradient,
}

/// `volgraph test`.
#[derive(ClapArgs, Debug)]
pub struct TestArgs {
    /// Case files, and folders that hold some.
    #[arg(required_unless_present = "scenes")]
    pub paths: Vec<PathBuf>,
    /// Only expectations whose name, such as `tests/glow.ron: finite [image.step=0.5]`, has this in it; may be given again
    /// for more.
    #[arg(short, long, value_name = "WORDS")]
    pub filter: Vec<String>,
    /// A filter is a whole name, with or without its settings, or a case's file, or its name alone.
    #[arg(long, requires = "filter")]
    pub exact: bool,
    /// List what would be run, and run nothing.
    #[arg(long)]
    pub list: bool,
    /// List volgraph's own scenes, in which a slot can be tested without a graph.
    #[arg(long)]
    pub scenes: bool,
    /// Cases that run at the same time, each on a device of its own; by default as many as there are cores, at most 4.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    pub jobs: Option<u16>,
    /// Begin no case after one that failed.
    #[arg(long)]
    pub fail_fast: bool,
    /// Run expectations of times as well, one case after the other.
    #[arg(long)]
    pub timing: bool,
    /// Write the stored pictures instead of comparing with them: look at them before you keep them.
    #[arg(long)]
    pub bless: bool,
    /// Write the results as JUnit XML, which most CI systems read.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write a page with pictures, differences and curves into this folder.
    #[arg(long, value_name = "FOLDER")]
    pub html: Option<PathBuf>,
    /// Where shaders are.
    #[command(flatten)]
    pub shaders: ShaderArgs,
    /// Where volumes are.
    #[command(flatten)]
    pub data: DataArgs,
    /// The adapter: part of its name, a backend (vulkan, gl, metal, dx12) or a class (discrete, software, …).
    #[arg(long, value_name = "WORDS", env = "VOLGRAPH_ADAPTER")]
    pub adapter: Option<String>,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// `volgraph gallery`.
#[derive(ClapArgs, Debug)]
pub struct GalleryArgs {
    /// Only these ready graphs.
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// The folder for the pictures, index.html and gallery.md; it is made where it is not there.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
    /// Frames of each graph that are timed, after the first.
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub frames: u32,
    /// What each graph is drawn with.
    #[command(flatten)]
    pub each: EachSceneArgs,
}

/// `volgraph graphs`.
#[derive(ClapArgs, Debug)]
pub struct GraphsArgs {
    /// Only this one: its text.
    pub name: Option<String>,
    /// The graph that fits a volume file, as it is drawn where the volume stands in a graph's place.
    #[arg(long = "for", value_name = "VOLUME", conflicts_with_all = ["name", "write", "json"])]
    pub volume: Option<PathBuf>,
    /// Write that graph into this file, and its transfer function beside it.
    #[arg(short, long, value_name = "FILE", requires = "volume")]
    pub output: Option<PathBuf>,
    /// Copy the graph, its transfer functions and images into the folder.
    #[arg(long, requires = "name")]
    pub write: bool,
    /// The folder to copy into.
    #[arg(long, value_name = "FOLDER", default_value = ".", requires = "write")]
    pub folder: PathBuf,
    /// Overwrite what is there.
    #[arg(long)]
    pub force: bool,
    /// Print JSON.
    #[arg(long, conflicts_with = "write")]
    pub json: bool,
}

/// `volgraph set`.
#[derive(ClapArgs, Debug)]
pub struct SetArgs {
    /// The graph file; or the name of a ready graph, with -o.
    pub graph: PathBuf,
    /// Parameters, slots and fields of sources, and what they are set to.
    #[arg(value_name = "NODE.PARAM=VALUE | NODE.slots.SLOT=CHOICE", value_parser = ParamOverride::parse)]
    pub set: Vec<ParamOverride>,
    /// Take a parameter, slot or field out of the graph; may be given again.
    #[arg(long, value_name = "NODE.PARAM | NODE.slots.SLOT", value_parser = parse_unset)]
    pub unset: Vec<ParamOverride>,
    /// Draw another volume file for a source of the graph; may be given again.
    #[arg(long, value_name = "[NAME=]FILE", value_parser = parse_volume)]
    pub volume: Vec<(String, PathBuf)>,
    /// The camera, as a graph writes it: orbit(azimuth: 40, elevation: 25) or look_at(eye: (1, 2, 3)).
    #[arg(long, value_name = "CAMERA", value_parser = parse_camera)]
    pub camera: Option<CameraDesc>,
    /// Write another file, and leave the graph as it is. Paths of files beside the graph are changed to lead there.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Overwrite the file of -o.
    #[arg(long, requires = "output")]
    pub force: bool,
    /// Print the lines that would change, and write nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Where volumes are.
    #[command(flatten)]
    pub data: DataArgs,
    /// Where shaders are.
    #[command(flatten)]
    pub shaders: ShaderArgs,
}

fn parse_unset(text: &str) -> Result<ParamOverride, String> {
    let help = |_| "name a node and its parameter: node.param".to_owned();
    ParamOverride::parse(&format!("{text}=0")).map_err(help)
}

/// `volgraph transfer`.
#[derive(ClapArgs, Debug)]
pub struct TransferArgs {
    /// The volume that it is for.
    #[arg(required_unless_present = "list", conflicts_with = "list")]
    pub volume: Option<PathBuf>,
    /// The preset; --list tells them.
    #[arg(
        long,
        value_name = "NAME",
        required_unless_present = "list",
        conflicts_with = "list"
    )]
    pub preset: Option<String>,
    /// List the presets and the names of colour maps.
    #[arg(long)]
    pub list: bool,
    /// The file; without it the text is printed.
    #[arg(short, long, value_name = "FILE", conflicts_with = "list")]
    pub output: Option<PathBuf>,
    /// Overwrite what is there; the comments that it begins with stay.
    #[arg(long, requires = "output")]
    pub force: bool,
}
