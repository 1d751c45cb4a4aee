//! The arguments of `volgraph verify`.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use volgraph::verify::Axis;

use super::accuracy::TruthArgs;
use super::{SceneArgs, parse_slot};

/// The word for a stock scene in the place of a graph.
pub const STOCK: &str = "stock";

/// `volgraph verify`.
#[derive(ClapArgs, Debug)]
#[command(
    mut_arg("graph", |arg| arg.required(false).default_value(STOCK).value_name("GRAPH | PICTURE").help(
        "The graph; or a picture (.png, .exr) that volgraph has written; or `stock`, for the stock scene that tests what \
         `--slot` chooses",
    )),
    mut_arg("size", |arg| arg.default_value("48x48").help("Width and height of the pictures in pixels; a picture has its own")),
)]
pub struct VerifyArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Measure orders of convergence: in the step, the grid of analytic sources, the pixel. Axes that are named and cannot
    /// be measured fail; without names it is the step, and the grid where it can be.
    #[arg(
        long,
        value_name = "AXES",
        num_args = 0..=1,
        require_equals = true,
        value_delimiter = ',',
    )]
    pub orders: Option<Vec<AxisArg>>,
    /// Choose for a slot of every raycast: a name, or a path that ends in .wgsl; may be given again.
    #[arg(long, value_name = "SLOT=CHOICE", value_parser = parse_slot)]
    pub slot: Vec<(String, String)>,
    /// What a choice of your own approximates: the truth is computed with this one in its place, such as technique=dvr.
    /// Choices of `classify` all approximate one integral and need none. May be given again.
    #[arg(long = "as", value_name = "SLOT=CHOICE", value_parser = parse_slot)]
    pub stands_for: Vec<(String, String)>,
    /// The coarsest step in voxels; chosen by the volume's size where it is not given.
    #[arg(long, value_name = "STEP", value_parser = parse_step)]
    pub from: Option<f64>,
    /// How often the step is halved: 4 to 12 times, 4 by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=12))]
    pub halvings: Option<u32>,
    /// How far below the declared order the measured one may be: 0.15 by default.
    #[arg(long, value_name = "ORDER", value_parser = super::parse_bound)]
    pub tolerance_order: Option<f64>,
    /// Hold against this order in the step, whatever is declared.
    #[arg(long, value_name = "ORDER", value_parser = super::parse_bound)]
    pub expect: Option<f64>,
    /// An error that stands still below this has met rounding or tables; higher up that counts against the method.
    /// 2e-5 by default.
    #[arg(long, value_name = "ERROR", value_parser = super::parse_bound)]
    pub floor: Option<f64>,
    /// Draw a plot for each study into this folder, as .svg.
    #[arg(long, value_name = "FOLDER")]
    pub svg: Option<PathBuf>,
    /// Compare a picture with its truth as well: `reference`.
    #[arg(long, value_name = "reference", value_parser = ["reference"])]
    pub against: Option<String>,
    /// How the truth is computed.
    #[command(flatten)]
    pub truth: TruthArgs,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// What is halved.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisArg {
    /// The step.
    Step,
    /// The grid of analytic sources.
    Grid,
    /// The pixel.
    Pixel,
}

impl From<AxisArg> for Axis {
    fn from(axis: AxisArg) -> Self {
        match axis {
            AxisArg::Step => Self::Step,
            AxisArg::Grid => Self::Grid,
            AxisArg::Pixel => Self::Pixel,
        }
    }
}

fn parse_step(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(step) if step > 0.0 && step.is_finite() => Ok(step),
        _ => Err("a step is a number of voxels above 0".to_owned()),
    }
}
