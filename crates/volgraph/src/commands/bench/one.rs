//! One graph, beside its limit.

use std::process::ExitCode;
use std::sync::Arc;

use serde_json::{Value, json};
use volgraph::bench::{device_bytes, empty_of, limit_of, peak_resident_bytes};
use volgraph::methods::{middle, timed_frame, turned};
use volgraph::{Findings, Scene, Session, SessionOptions, open_beside};
use volgraph_gpu::Gpu;
use volgraph_measure::timing::{Summary, ratio};

use super::edits;
use crate::args::{BenchArgs, SceneArgs};
use crate::commands::{load, session_options};
use crate::{clock, output};

pub fn run(args: &BenchArgs, scene_args: &SceneArgs) -> anyhow::Result<ExitCode> {
    let options = session_options(scene_args, None);
    let (scene, gpu) = open_beside(&options.adapter, || load(scene_args));
    let scene = scene?;
    let gpu = Arc::new(gpu?);
    let reads_back = !args.no_read_back;
    let mut session = Session::start(scene, Arc::clone(&gpu), &options)?;
    // The first picture is the graph's own view.
    let mut last = session.draw()?;
    if reads_back {
        session.read("color")?;
    }
    let first_picture_ms = clock::milliseconds();
    let peak_resident = peak_resident_bytes();
    let (first, target) = (session.view().camera, middle(session.plan()));
    // What a budget has chosen is in the session's own scene.
    let limits = if args.no_limit {
        None
    } else {
        limits(session.scene(), &gpu, &options)
    };
    let mut sessions = vec![session];
    sessions.extend(limits.into_iter().flatten());
    let (frames, warm_up) = (args.frames.unwrap_or(9), args.warm_up.unwrap_or(3));
    let turn = args.turn.unwrap_or(1.0);
    let mut times = vec![Vec::new(); sessions.len()];
    let mut gpu_ms: Vec<f64> = Vec::new();
    for number in 1..=warm_up + frames {
        let camera = turned(&first, target, f64::from(number) * turn);
        let mut order: Vec<usize> = (0..sessions.len()).collect();
        // Forwards and backwards, so that what comes first and what comes last change places.
        if number % 2 == 0 {
            order.reverse();
        }
        for at in order {
            let (ms, report) = timed_frame(&mut sessions[at], camera, reads_back)?;
            if number > warm_up {
                times[at].push(ms);
            }
            if at == 0 {
                let nodes = report.nodes.iter().filter_map(|node| node.gpu_ms);
                let device: Vec<f64> = nodes.collect();
                if number > warm_up && !device.is_empty() {
                    gpu_ms.push(device.iter().sum());
                }
                last = report;
            }
        }
    }
    let (session, frame_ms) = (&sessions[0], &times[0]);
    let summary = Summary::of(frame_ms)?;
    // Some devices tell no times.
    let device = Summary::of(&gpu_ms).ok();
    let limit = match &times[..] {
        [frame_ms, limit_ms, empty_ms] => Limit::of(frame_ms, limit_ms, empty_ms),
        _ => None,
    };
    let edits = match args.edits {
        Some(edits) => Some(edits::run(scene_args, edits, &gpu, &options)?),
        None => None,
    };
    if args.json {
        output::print_json(&json!({
            "adapter": session.adapter(),
            "size": scene_args.size,
            "reads_back": reads_back,
            "frame_ms": { "min": summary.min, "median": summary.median, "max": summary.max, "all": frame_ms },
            "gpu_ms": device.map(|device| json!({ "min": device.min, "median": device.median, "max": device.max })),
            "limit": limit.as_ref().map(Limit::to_json),
            "first_picture_ms": first_picture_ms,
            "peak_resident_bytes": peak_resident,
            "device_bytes": device_bytes(session),
            "edits": edits,
            "last_frame": last,
        }));
        return Ok(ExitCode::SUCCESS);
    }
    output::print(&format!(
        "{} frames of {}x{} on {}: median {:.1} ms, {:.1} to {:.1}{}",
        summary.n,
        scene_args.size[0],
        scene_args.size[1],
        session.adapter(),
        summary.median,
        summary.min,
        summary.max,
        device.map_or_else(String::new, |device| format!(
            "; on the device {:.1} ms",
            device.median
        ))
    ));
    if let Some(limit) = limit {
        output::print(&limit.words());
    }
    output::print(&format!(
        "first picture {first_picture_ms:.0} ms after the start; until then {}",
        memory(session, peak_resident),
    ));
    if let Some(edits) = edits {
        output::print(&edits.words());
    }
    Ok(ExitCode::SUCCESS)
}

/// What the device holds, and the most that the process has held. A software device's memory is the process's.
pub fn memory(session: &Session, peak_resident: Option<u64>) -> String {
    let device = mib(device_bytes(session));
    match peak_resident.map(mib) {
        None => format!("{device} on the device"),
        Some(peak) if session.adapter().class == "software" => {
            format!("at most {peak} of main memory, {device} of it as the device's")
        }
        Some(peak) => format!("at most {peak} of main memory, and {device} on the device"),
    }
}

/// Bytes for people.
pub fn mib(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}

/// Sessions of the limit and of the empty frame; none where the picture is of no raycast.
fn limits(scene: &Scene, gpu: &Arc<Gpu>, options: &SessionOptions) -> Option<[Session; 2]> {
    let open = |scene: Result<Scene, Findings>| {
        let mut session = Session::start(scene.ok()?, Arc::clone(gpu), options).ok()?;
        session.draw().ok()?;
        Some(session)
    };
    Some([open(limit_of(scene))?, open(empty_of(scene))?])
}

/// The limit beside the graph.
struct Limit {
    limit: Summary,
    empty: Summary,
    ratio: Summary,
}

impl Limit {
    fn of(frame_ms: &[f64], limit: &[f64], empty: &[f64]) -> Option<Self> {
        Some(Self {
            limit: Summary::of(limit).ok()?,
            empty: Summary::of(empty).ok()?,
            ratio: ratio(frame_ms, limit).ok()?,
        })
    }

    fn to_json(&self) -> Value {
        json!({ "limit_ms": self.limit, "empty_ms": self.empty, "ratio": self.ratio })
    }

    fn words(&self) -> String {
        format!(
            "{:.2} times the limit, which takes the same samples and adds them up: {:.1} ms, of which {:.1} are an empty frame",
            self.ratio.median, self.limit.median, self.empty.median
        )
    }
}
