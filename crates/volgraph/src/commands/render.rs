//! `volgraph render`: a graph into a picture.

use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde_json::json;
use volgraph::{Findings, Session, SessionOptions};
use volgraph_gpu::Gpu;
use volgraph_picture::{PictureError, PngBits, SaveOptions};

use super::{errors, load};
use crate::args::RenderArgs;
use crate::output;

pub fn run(args: &RenderArgs) -> anyhow::Result<ExitCode> {
    let extension = args
        .output
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or("")
        .to_lowercase();
    if extension != "png" && extension != "exr" {
        let error = PictureError::Extension {
            path: args.output.clone(),
        };
        return Err(Findings::from(errors::of_picture(&error, &args.output)).into());
    }
    let start = Instant::now();
    let scene = load(&args.scene)?;
    let options = SessionOptions {
        adapter: args.scene.adapter_choice(),
        size: args.scene.size,
        overrides: args.scene.overrides(),
        shader_folders: args.scene.shader_folders(),
        with_layers: extension == "exr",
    };
    let gpu = Arc::new(Gpu::open(&options.adapter)?);
    let mut session = Session::start(scene, gpu, &options)?;
    let ready = start.elapsed();
    let (picture, report) = session.render()?;
    let drawn = start.elapsed();
    let bits = if args.png_bits == "16" {
        PngBits::Sixteen
    } else {
        PngBits::Eight
    };
    let saved = picture
        .save(&args.output, SaveOptions::default().with_png_bits(bits))
        .map_err(|error| Findings::from(errors::of_picture(&error, &args.output)))?;
    if saved.nan_pixels > 0 {
        output::warn(&format!(
            "{} pixels are not numbers: a shader divides by zero or takes a root of a negative number",
            saved.nan_pixels
        ));
    }
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
