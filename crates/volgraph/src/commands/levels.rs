//! `volgraph levels`: what a picture loses on each level of a volume in bricks.

use std::fmt::Write as _;
use std::process::ExitCode;
use std::sync::Arc;

use serde_json::json;
use volgraph::{Gpu, levels};

use super::reference::Rows;
use super::{load, session_options};
use crate::args::LevelsArgs;
use crate::output;
use crate::progress::Bars;

pub fn run(args: &LevelsArgs) -> anyhow::Result<ExitCode> {
    let scene = load(&args.scene)?;
    let options = session_options(&args.scene, None);
    let gpu = Arc::new(Gpu::open(&options.adapter)?);
    let crop = args.crop.map(|crop| [crop.low, crop.dims]);
    let bars = Bars::new();
    let measured = levels::measure(
        &scene,
        crop,
        &options,
        &args.truth.options(),
        &gpu,
        &Rows(&bars),
    );
    bars.clear();
    let measured = measured?;
    if args.json {
        output::print_json(&json!(measured));
        return Ok(ExitCode::SUCCESS);
    }
    let [[x, y, z], [nx, ny, nz]] = measured.crop;
    let [width, height] = measured.size;
    let mut text = format!(
        "`{}` from {x},{y},{z}, {nx}x{ny}x{nz} voxels, {width}x{height} pixels, against the float64 reference of level 0\n",
        measured.source
    );
    text.push_str(
        "level  dims               bricks   scalars' rms    picture's rmse   largest   estimated\n",
    );
    for level in &measured.levels {
        let dims = level.dims.map(|n| n.to_string()).join("x");
        let estimated = level.about.rsplit(' ').next().unwrap_or_default();
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "{:<6} {dims:<18} {:<8} {:<15.6} {:<16.3e} {:<9.1e} {estimated}",
            level.level, level.bricks, level.scalar_rms, level.rmse, level.max
        );
    }
    output::print(text.trim_end());
    Ok(ExitCode::SUCCESS)
}
