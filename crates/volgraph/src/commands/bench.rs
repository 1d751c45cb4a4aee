//! `volgraph bench`: the time of frames while the camera turns.

use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde_json::json;
use volgraph::Session;
use volgraph::methods::{middle, turned};
use volgraph_gpu::Gpu;
use volgraph_measure::timing::Summary;

use super::{load, session_options};
use crate::args::BenchArgs;
use crate::output;

pub fn run(args: &BenchArgs) -> anyhow::Result<ExitCode> {
    let scene = load(&args.scene)?;
    let options = session_options(&args.scene, None);
    let gpu = Arc::new(Gpu::open(&options.adapter)?);
    let mut session = Session::start(scene, gpu, &options)?;
    let first = *session.view();
    let target = middle(session.plan());
    let mut frame_ms = Vec::new();
    let mut gpu_ms: Vec<f64> = Vec::new();
    let mut last = None;
    for frame in 0..args.warm_up + args.frames {
        session.place_camera(turned(&first.camera, target, f64::from(frame) * args.turn));
        let start = Instant::now();
        let report = session.draw()?;
        if !args.no_read_back {
            session.read("color")?;
        }
        if frame >= args.warm_up {
            frame_ms.push(start.elapsed().as_secs_f64() * 1e3);
            let times: Vec<f64> = report.nodes.iter().filter_map(|node| node.gpu_ms).collect();
            if !times.is_empty() {
                gpu_ms.push(times.iter().sum());
            }
        }
        last = Some(report);
    }
    let frames = Summary::of(&frame_ms)?;
    // Some devices tell no times.
    let device = Summary::of(&gpu_ms).ok();
    if args.json {
        output::print_json(&json!({
            "adapter": session.adapter(),
            "size": args.scene.size,
            "reads_back": !args.no_read_back,
            "frame_ms": { "min": frames.min, "median": frames.median, "max": frames.max, "all": frame_ms },
            "gpu_ms": device.map(|device| json!({ "min": device.min, "median": device.median, "max": device.max })),
            "last_frame": last,
        }));
    } else {
        output::print(&format!(
            "{} frames of {}x{} on {}: median {:.1} ms, {:.1} to {:.1}{}",
            frames.n,
            args.scene.size[0],
            args.scene.size[1],
            session.adapter(),
            frames.median,
            frames.min,
            frames.max,
            device.map_or_else(String::new, |device| format!(
                "; on the device {:.1} ms",
                device.median
            ))
        ));
    }
    Ok(ExitCode::SUCCESS)
}
