//! `volgraph render`: a graph into a picture.
//!
//! On a machine with no adapter at all the software raycaster draws what it covers, the float64 reference what else that
//! covers, and both say so.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::json;
use volgraph::bench::{device_bytes, peak_resident_bytes};
use volgraph::quality::{Chosen, achieved};
use volgraph::truth::plan_without_device;
use volgraph::{
    Findings, FrameReport, Picture, Scene, Session, TILE_SIDE, Truth, TruthOptions,
    has_to_be_tiled, list_adapters, metadata, open_beside,
};
use volgraph_gpu::GpuError;
use volgraph_picture::{SaveOptions, SaveReport};

use super::bench::memory;
use super::reference::Rows;
use super::software;
use super::{check_output, check_overwrites, errors, load, png_bits, session_options};
use crate::args::RenderArgs;
use crate::output;
use crate::progress::Bars;

/// Tolerance of pictures that the reference draws because nobody else can: below what any file shows.
const TOLERANCE: f64 = 1e-6;

pub fn run(args: &RenderArgs) -> anyhow::Result<ExitCode> {
    check_output(&args.output)?;
    let start = Instant::now();
    let mut options = session_options(&args.scene, Some(&args.output));
    let (scene, gpu) = open_beside(&options.adapter, || load(&args.scene));
    let scene = scene?;
    let inputs = scene.data.keys().chain([&scene.path]);
    check_overwrites(&args.output, inputs.map(PathBuf::as_path))?;
    let gpu = match gpu {
        Ok(gpu) => Arc::new(gpu),
        Err(error @ GpuError::NoAdapter { .. }) if list_adapters().is_empty() => {
            return without_adapter(args, &scene, start, error);
        }
        Err(error) => return Err(error.into()),
    };
    let size = args.scene.size;
    let is_tiled = args.tile.is_some() || has_to_be_tiled(size, &options.limits(&gpu));
    if is_tiled {
        // Of the session itself nothing is drawn.
        let side = args.tile.unwrap_or(TILE_SIDE);
        options.size = size.map(|pixels| pixels.min(side));
    }
    let mut session = Session::start(scene, gpu, &options)?;
    let ready = start.elapsed();
    let (picture, report) = if is_tiled {
        let (picture, hazards) = draw_tiles(&mut session, size, args.tile)?;
        let report = FrameReport {
            hazards,
            ..FrameReport::default()
        };
        (picture, report)
    } else {
        session.render()?
    };
    let drawn = start.elapsed();
    let saved = save(args, &picture)?;
    if saved.nan_pixels > 0 {
        output::warn(&format!(
            "{} pixels are not numbers: a shader divides by zero or takes a root of a negative number",
            saved.nan_pixels
        ));
    }
    output::report_warnings(&report.all_warnings());
    let chosen = session.chosen();
    let achieved = chosen
        .filter(|_| !is_tiled)
        .and_then(|_| achieved(session.plan(), session.view(), &picture));
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
            "quality": chosen,
            "achieved": achieved.map(|(rmse, pixels)| json!({ "rmse": rmse, "pixels": pixels })),
            "device_bytes": device_bytes(&session),
            "peak_resident_bytes": peak_resident_bytes(),
            "frame": report,
        }));
    } else {
        output::print(&format!(
            "{} {}x{} in {:.0} ms on {}; {}",
            args.output.display(),
            picture.width,
            picture.height,
            milliseconds(start.elapsed()),
            session.adapter(),
            memory(&session, peak_resident_bytes())
        ));
        if let Some(chosen) = chosen {
            output::print(&if is_tiled {
                format!("{chosen}; what was achieved is not known of a picture in tiles")
            } else {
                quality(chosen, achieved)
            });
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Draws a picture tile by tile.
fn draw_tiles(
    session: &mut Session,
    size: [u32; 2],
    side: Option<u32>,
) -> Result<(Picture, Findings), Findings> {
    let bars = Bars::new();
    let drawn = session.render_tiled(size, side, &mut |done, total| {
        bars.count("drawing tiles", done as u64, total as u64);
    });
    bars.clear();
    drawn
}

/// What was chosen for the graph's budget, and what came of it.
fn quality(chosen: &Chosen, achieved: Option<(f64, usize)>) -> String {
    let achieved = match achieved {
        Some((rmse, pixels)) => format!("achieved rmse {rmse:.2e} on {pixels} pixels"),
        None => {
            "what was achieved is not known: the reference does not compute this graph".to_owned()
        }
    };
    let kept = if chosen.is_kept {
        " (chosen before)"
    } else {
        ""
    };
    format!("{chosen}{kept}; {achieved}")
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

fn save(args: &RenderArgs, picture: &Picture) -> Result<SaveReport, Findings> {
    let bits = png_bits(&args.png_bits);
    picture
        .save(&args.output, SaveOptions::default().with_png_bits(bits))
        .map_err(|error| errors::of_picture(&error, &args.output).into())
}

/// Who draws what the software raycaster does not, where there is no adapter.
const REFERENCE: &str = "the float64 reference, on the processor";

/// Draws on the processor, for there is no adapter.
fn without_adapter(
    args: &RenderArgs,
    scene: &Scene,
    start: Instant,
    no_adapter: GpuError,
) -> anyhow::Result<ExitCode> {
    scene.check_color_output().map_err(Findings::from)?;
    let plan = plan_without_device(scene, args.scene.size)?;
    let view = plan.view();
    let ready = start.elapsed();
    match software::draw(&plan, &view) {
        Ok((mut picture, who)) => {
            let drawn = start.elapsed();
            picture.metadata = metadata::of(scene, &plan, &view, &who);
            let times = json!({
                "ready_ms": milliseconds(ready),
                "frame_ms": milliseconds(drawn - ready),
            });
            return finish_without_adapter(args, &picture, start, &who, times);
        }
        Err(finding) if finding.code != "not-covered" => return Err(Findings::from(finding).into()),
        // The reference says what neither covers.
        Err(_) => {}
    }
    let bars = Bars::new();
    let options = TruthOptions {
        tolerance: TOLERANCE,
        ..TruthOptions::default()
    };
    let truth = Truth::of(&plan, &view, &options, &Rows(&bars));
    bars.clear();
    let truth = match truth {
        Ok(truth) => truth,
        // Why the reference does not draw it either belongs to the remedy.
        Err(findings) => {
            output::note(&format!("without an adapter: {findings}"));
            return Err(no_adapter.into());
        }
    };
    let mut picture = truth.picture()?;
    picture.metadata = metadata::of(scene, &plan, &view, &REFERENCE);
    let tolerance = json!({ "tolerance": TOLERANCE });
    finish_without_adapter(args, &picture, start, REFERENCE, tolerance)
}

/// Saves a picture that was drawn on the processor, and says by whom.
fn finish_without_adapter(
    args: &RenderArgs,
    picture: &Picture,
    start: Instant,
    who: &str,
    more: serde_json::Value,
) -> anyhow::Result<ExitCode> {
    let saved = save(args, picture)?;
    output::note(&format!("there is no adapter: this is drawn by {who}"));
    let [width, height] = args.scene.size;
    if args.json {
        let mut report = json!({
            "output": args.output.display().to_string(),
            "size": args.scene.size,
            "adapter": who,
            "total_ms": milliseconds(start.elapsed()),
            "nan_pixels": saved.nan_pixels,
            "clipped_pixels": saved.clipped_pixels,
        });
        if let (Some(report), serde_json::Value::Object(more)) = (report.as_object_mut(), more) {
            report.extend(more);
        }
        output::print_json(&report);
    } else {
        output::print(&format!(
            "{} {width}x{height} in {:.0} ms by {who}",
            args.output.display(),
            milliseconds(start.elapsed()),
        ));
    }
    Ok(ExitCode::SUCCESS)
}
