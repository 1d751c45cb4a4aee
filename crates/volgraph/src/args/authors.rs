//! The arguments of the commands for authors of shaders and graphs.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use super::{DataArgs, ShaderArgs};

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
    #[arg(required = true)]
    pub paths: Vec<PathBuf>,
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
