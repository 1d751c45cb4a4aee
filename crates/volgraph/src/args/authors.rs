//! The arguments of the commands for authors of shaders and graphs.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use super::{DataArgs, EachSceneArgs, ShaderArgs};

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
    /// Copy the graph, its transfer functions and images into the folder.
    #[arg(long, requires = "name")]
    pub write: bool,
    /// The folder to copy into.
    #[arg(long, value_name = "FOLDER", default_value = ".", requires = "write")]
    pub folder: PathBuf,
    /// Overwrite what is there.
    #[arg(long, requires = "write")]
    pub force: bool,
    /// Print JSON.
    #[arg(long, conflicts_with = "write")]
    pub json: bool,
}
