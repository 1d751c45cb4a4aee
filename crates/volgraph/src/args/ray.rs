//! The arguments of `volgraph ray`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use super::SceneArgs;
use super::accuracy::parse_tolerance;

/// `volgraph ray`.
#[derive(ClapArgs, Debug)]
pub struct RayArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The pixel: column and row, from 0 at the top left.
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel)]
    pub pixel: [f64; 2],
    /// Draw scalar, extinction, transmittance and contribution over the distance into this .svg file.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Absolute tolerance of the reference, in linear premultiplied colours.
    #[arg(long, value_name = "T", default_value = "1e-8", value_parser = parse_tolerance)]
    pub tolerance: f64,
    /// Print every segment; of long walks the middle is left out otherwise.
    #[arg(long)]
    pub all: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

fn parse_pixel(text: &str) -> Result<[f64; 2], String> {
    let how = "write it as COLUMN,ROW, such as 256,256";
    let (x, y) = text.split_once(',').ok_or(how)?;
    let number = |text: &str| match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err(format!("`{text}` is no number of at least 0: {how}")),
    };
    Ok([number(x)?, number(y)?])
}
