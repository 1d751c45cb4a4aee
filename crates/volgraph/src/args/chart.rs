//! The arguments of `volgraph chart`.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use volgraph::methods::{Filter, SurveyOptions, parse_filters};

use super::EachSceneArgs;
use super::accuracy::TruthArgs;

/// `volgraph chart`.
#[derive(ClapArgs, Debug)]
pub struct ChartArgs {
    /// Graph files, or names of ready graphs.
    #[arg(required = true, value_name = "GRAPH")]
    pub graphs: Vec<PathBuf>,
    /// The folder for index.html and, of each graph, a table (.csv), a chart (.svg) and pictures; it is made where it is not
    /// there.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
    /// Only these methods: values of slots and parameters of the raycast, such as
    /// "classify=post,preintegrated_2d step=0.25..4 stage=*". A range goes in doubles.
    #[arg(long, value_name = "NAME=VALUES …", default_value = "", value_parser = parse_methods)]
    pub methods: Methods,
    /// Seconds for the methods of each graph, besides those for its truth, which are told. Spaces of at most 64 methods are measured as a whole even where that takes longer.
    #[arg(long, value_name = "S", default_value_t = 180.0, value_parser = parse_seconds)]
    pub seconds: f64,
    /// Frames of each method near the front, at most; fewer where the time is over.
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub frames: u32,
    /// Frames of every method in the first pass.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub first_frames: u32,
    /// Frames before them that are not timed.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    pub warm_up: u32,
    /// What pictures are held against; without it the reference, and where that does not compute what the graph draws, the
    /// same graph at a step of 1/32 voxel.
    #[arg(long, value_name = "KIND")]
    pub truth: Option<TruthChoice>,
    /// Other renderers' figures, a table of tab separated values; they are drawn into the charts of the scenes that they
    /// drew.
    #[arg(long, value_name = "FILE")]
    pub peers: Option<PathBuf>,
    /// How the reference is computed.
    #[command(flatten)]
    pub reference: TruthArgs,
    /// What each graph is drawn with.
    #[command(flatten)]
    pub each: EachSceneArgs,
}

/// Filters, and as they were typed.
#[derive(Clone, Debug)]
pub struct Methods {
    /// As filters.
    pub filters: Vec<Filter>,
    /// As they were typed.
    pub typed: String,
}

/// What pictures are held against.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum TruthChoice {
    /// The float64 reference.
    Reference,
    /// The same graph at a very fine step.
    Fine,
}

impl ChartArgs {
    /// How each graph's methods are gone through.
    pub fn survey(&self) -> SurveyOptions {
        SurveyOptions {
            seconds: self.seconds,
            warm_up: self.warm_up,
            scout_rounds: self.first_frames,
            rounds: self.frames,
            ..SurveyOptions::default()
        }
    }
}

fn parse_methods(text: &str) -> Result<Methods, String> {
    Ok(Methods {
        filters: parse_filters(text)?,
        typed: text.to_owned(),
    })
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds >= 0.0 => Ok(seconds),
        _ => Err("give a number of seconds".to_owned()),
    }
}
