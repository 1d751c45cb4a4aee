//! The arguments of `volgraph animate`.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use volgraph::film::MAX_FRAMES;

use super::SceneArgs;

/// `volgraph animate`.
#[derive(ClapArgs, Debug)]
pub struct AnimateArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// A folder for frame_0000.png and so on, which is made where it is not there; or one animated file, .png, .apng (as
    /// the frames are) or .gif (256 colours a frame).
    #[arg(short, long, value_name = "FOLDER | FILE")]
    pub output: PathBuf,
    /// The camera's path: a RON file of keys, such as (path: 1, keys: [(at: 0, camera: orbit(azimuth: 0)),
    /// (at: 119, camera: orbit(azimuth: 90, zoom: 2), set: { "image.step": 0.5 })]). Without it the camera goes around
    /// its target.
    #[arg(long, value_name = "FILE", conflicts_with = "degrees")]
    pub path: Option<PathBuf>,
    /// How far the camera goes around, in degrees; whole turns close without a doubled frame. Below 0 it goes the other way.
    /// 360 by default; with --steps 0.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = parse_degrees)]
    pub degrees: Option<f64>,
    /// Go over the time steps of the volumes that have several: `all`, or from one to another.
    #[arg(long, value_name = "all | FIRST..LAST", value_parser = parse_steps)]
    pub steps: Option<Steps>,
    /// How many frames; by default those of the path, one for each time step, or 120.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_FRAMES)))]
    pub frames: Option<u32>,
    /// Frames per second of an animated file; by default those that the path says, or 25.
    #[arg(long, value_name = "N", value_parser = parse_rate)]
    pub fps: Option<f64>,
    /// Bits of each PNG component: 8 or 16.
    #[arg(long, value_name = "BITS", default_value = "8", value_parser = ["8", "16"])]
    pub png_bits: String,
    /// Print what came of it as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Time steps of a film.
#[derive(Clone, Copy, Debug)]
pub enum Steps {
    /// From the first to the last that there is.
    All,
    /// From one to another, both drawn; backwards where the second is lower.
    Between(u32, u32),
}

fn parse_steps(text: &str) -> Result<Steps, String> {
    if text == "all" {
        return Ok(Steps::All);
    }
    let ends = text.split_once("..").and_then(|(first, last)| {
        let last = last.strip_prefix('=').unwrap_or(last);
        Some((first.parse().ok()?, last.parse().ok()?))
    });
    let (first, last) = ends.ok_or("write `all`, or the first and the last step as in 0..24")?;
    Ok(Steps::Between(first, last))
}

fn parse_degrees(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees.abs() <= 360_000.0 => Ok(degrees),
        _ => Err("give a number of degrees, at most 360000".to_owned()),
    }
}

fn parse_rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (0.01..=1000.0).contains(&rate) => Ok(rate),
        _ => Err("give a number from 0.01 to 1000".to_owned()),
    }
}
