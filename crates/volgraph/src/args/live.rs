//! The arguments of the commands that go on: `watch` and `view`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use super::SceneArgs;

/// `volgraph watch`.
#[derive(ClapArgs, Debug)]
pub struct WatchArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The picture: .png, or .exr with depth, opacity and the graph's other outputs as layers. It is replaced as a whole, never half written.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Bits of each PNG component: 8 or 16.
    #[arg(long, value_name = "BITS", default_value = "8", value_parser = ["8", "16"])]
    pub png_bits: String,
    /// Run a shell command after each picture, with its file in VOLGRAPH_PICTURE and its number in VOLGRAPH_NUMBER.
    /// While it runs, newer pictures wait; the last of them is next.
    #[arg(long, value_name = "COMMAND")]
    pub exec: Option<String>,
    /// Print how far each picture is from this one, instead of from the last; or from its truth, with the word `reference`.
    #[arg(long, value_name = "PICTURE | reference")]
    pub against: Option<PathBuf>,
    /// Look at the files every so many milliseconds, instead of being told by the system.
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u64).range(1..=3_600_000))]
    pub poll: Option<u64>,
    /// Print one JSON object a line.
    #[arg(long)]
    pub json: bool,
}

/// `volgraph view`.
#[derive(ClapArgs, Debug)]
pub struct ViewArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Most milliseconds of a frame while the camera moves: it is drawn as coarsely as that needs, and refined when it
    /// stands still. The window remembers the last value.
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub budget: Option<u32>,
    /// Orbit for so many seconds with pictures of --size, print how fluent that was, and close the window.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=600))]
    pub measure: Option<u32>,
}
