//! The arguments of the commands that measure accuracy.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use volgraph::TruthOptions;
use volgraph::truth::default_cache;

use super::{SceneArgs, ShaderArgs};

/// How the truth is computed.
#[derive(ClapArgs, Clone, Debug)]
pub struct TruthArgs {
    /// Absolute tolerance of the reference, in linear premultiplied colours.
    #[arg(long, value_name = "T", default_value = "1e-8", value_parser = parse_tolerance)]
    pub tolerance: f64,
    /// Compute the reference even where it is kept from before.
    #[arg(long)]
    pub no_cache: bool,
}

impl TruthArgs {
    /// As options.
    pub fn options(&self) -> TruthOptions {
        TruthOptions {
            tolerance: self.tolerance,
            cache: default_cache().filter(|_| !self.no_cache),
        }
    }
}

pub(super) fn parse_tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(tolerance) if (1e-10..=1.0).contains(&tolerance) => Ok(tolerance),
        _ => Err("a tolerance is a number between 1e-10 and 1".to_owned()),
    }
}

/// `volgraph reference`.
#[derive(ClapArgs, Debug)]
pub struct ReferenceArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The picture: .exr in linear f32, with depth, opacity, normals and the bound of the error as layers; or .png.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How the truth is computed.
    #[command(flatten)]
    pub truth: TruthArgs,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
}

/// `volgraph stress`.
#[derive(ClapArgs, Debug)]
pub struct StressArgs {
    /// Write a page (index.html) with pictures and curves into this folder.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Only the cases whose name has this text; may be given again.
    #[arg(long, value_name = "TEXT")]
    pub filter: Vec<String>,
    /// Say what there is, and draw nothing.
    #[arg(long)]
    pub list: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
    /// Where shaders are.
    #[command(flatten)]
    pub shaders: ShaderArgs,
    /// The adapter: part of its name, a backend (vulkan, gl, metal, dx12) or a class (discrete, software, …).
    #[arg(long, value_name = "WORDS", env = "VOLGRAPH_ADAPTER")]
    pub adapter: Option<String>,
}

/// `volgraph levels`.
#[derive(ClapArgs, Debug)]
pub struct LevelsArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The box of the finest level that is drawn, from the first voxel to behind the last one along x, y and z; by default
    /// 192 voxels along each edge, from the middle.
    #[arg(long, value_name = "X,Y,Z..X,Y,Z", value_parser = super::volumes::parse_crop)]
    pub crop: Option<super::volumes::Crop>,
    /// How the truth is computed.
    #[command(flatten)]
    pub truth: TruthArgs,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// `volgraph advise`.
#[derive(ClapArgs, Debug)]
pub struct AdviseArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Measure errors at steps of 4 to 1/4 voxels against the reference too.
    #[arg(long)]
    pub measure: bool,
    /// Width and height of the pictures that are measured.
    #[arg(long, value_name = "WxH", default_value = "64x64", value_parser = super::parse_size)]
    pub measure_size: [u32; 2],
    /// How the truth is computed.
    #[command(flatten)]
    pub truth: TruthArgs,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}
