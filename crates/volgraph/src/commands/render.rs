//! `volgraph render`: a graph into a picture.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde_json::json;
use volgraph::{Findings, Session};
use volgraph_gpu::Gpu;
use volgraph_picture::SaveOptions;

use super::{check_output, check_overwrites, errors, load, png_bits, session_options};
use crate::args::RenderArgs;
use crate::output;

pub fn run(args: &RenderArgs) -> anyhow::Result<ExitCode> {
    check_output(&args.output)?;
    let start = Instant::now();
    let scene = load(&args.scene)?;
    let inputs = scene.data.keys().chain([&scene.path]);
    check_overwrites(&args.output, inputs.map(PathBuf::as_path))?;
    let options = session_options(&args.scene, Some(&args.output));
    let gpu = Arc::new(Gpu::open(&options.adapter)?);
    let mut session = Session::start(scene, gpu, &options)?;
    let ready = start.elapsed();
    let (picture, report) = session.render()?;
    let drawn = start.elapsed();
    let bits = png_bits(&args.png_bits);
    let saved = picture
        .save(&args.output, SaveOptions::default().with_png_bits(bits))
        .map_err(|error| Findings::from(errors::of_picture(&error, &args.output)))?;
    if saved.nan_pixels > 0 {
        output::warn(&format!(
            "{} pixels are not numbers: a shader divides by zero or takes a root of a negative number",
            saved.nan_pixels
        ));
    }
    output::report_warnings(&report.hazards);
    let milliseconds = |duration: std::time::Duration| duration.as_secs_f64() * 1e3;
    if args.json {
        output::print_json(&json!({
            "output": args.output.display().to_string(),
            "size": args.scene.size,
            "adapter": session.adapter(),
            "ready_ms": milliseconds(ready),
            "frame_ms": milliseconds(drawn - ready),
            "total_ms": milliseconds(start.elapsed()),
            "nan_pixels": saved.nan_pixels,
            "clipped_pixels": saved.clipped_pixels,
            "frame": report,
        }));
    } else {
        output::print(&format!(
            "{} {}x{} in {:.0} ms on {}",
            args.output.display(),
            picture.width,
            picture.height,
            milliseconds(start.elapsed()),
            session.adapter()
        ));
    }
    Ok(ExitCode::SUCCESS)
}
