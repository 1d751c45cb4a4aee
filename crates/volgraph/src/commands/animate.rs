//! `volgraph animate`: a graph into a film, numbered pictures or one animated file.
//!
//! Frame after frame is drawn by one session and saved at once. On a machine with no adapter at all the software
//! raycaster draws what it covers.

mod target;

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde_json::json;
use volgraph::film::{CameraPath, Film, MAX_FRAMES};
use volgraph::truth::plan_without_device;
use volgraph::{
    Finding, Findings, Picture, Plan, Scene, Session, View, list_adapters, metadata, open_beside,
};
use volgraph_gpu::GpuError;

use self::target::Target;
use super::{load, png_bits, session_options, software};
use crate::args::{AnimateArgs, Steps};
use crate::output;
use crate::progress::Bars;

/// Frames of a turntable, and frames per second, where nobody says.
const FRAMES: u32 = 120;
const RATE: f64 = 25.0;

pub fn run(args: &AnimateArgs) -> anyhow::Result<ExitCode> {
    Target::check(&args.output)?;
    let start = Instant::now();
    let path = match &args.path {
        Some(file) => CameraPath::read(file)?,
        None => CameraPath::Turntable {
            degrees: args.degrees.unwrap_or(match args.steps {
                Some(_) => 0.0,
                None => 360.0,
            }),
        },
    };
    let rate = args.fps.or(path.frames_per_second()).unwrap_or(RATE);
    let options = session_options(&args.scene, None);
    let (scene, gpu) = open_beside(&options.adapter, || load(&args.scene));
    let scene = scene?;
    let steps = steps(args, &scene).map_err(Findings::from)?;
    let of_steps = steps.as_ref().map(Stepped::count);
    let frames = args.frames.or(path.frames()).or(of_steps);
    let frames = frames.unwrap_or(FRAMES).min(MAX_FRAMES);
    let inputs: Vec<PathBuf> = scene
        .data
        .keys()
        .chain([&scene.path])
        .chain(&args.path)
        .cloned()
        .collect();
    let mut target = Target::open(
        &args.output,
        frames,
        rate,
        png_bits(&args.png_bits),
        &inputs,
    )?;
    let who = match gpu {
        Ok(gpu) => {
            let mut session = Session::start(scene, Arc::new(gpu), &options)?;
            let film = film(&path, session.plan(), frames, steps.as_ref());
            draw(&film, &mut session, &mut target)?;
            session.adapter().to_string()
        }
        Err(GpuError::NoAdapter { .. }) if list_adapters().is_empty() => {
            let who = draw_without_adapter(args.scene.size, &scene, &mut target, |plan| {
                film(&path, plan, frames, steps.as_ref())
            })?;
            output::note(&format!("there is no adapter: this is drawn by {who}"));
            who
        }
        Err(error) => return Err(error.into()),
    };
    let saved = target.finish()?;
    if saved.nan_pixels > 0 {
        output::warn(&format!(
            "{} pixels are not numbers: a shader divides by zero or takes a root of a negative number",
            saved.nan_pixels
        ));
    }
    let [width, height] = args.scene.size;
    let total_ms = start.elapsed().as_secs_f64() * 1e3;
    if args.json {
        output::print_json(&json!({
            "output": args.output.display().to_string(),
            "size": args.scene.size,
            "frames": frames,
            "frames_per_second": rate,
            "adapter": who,
            "total_ms": total_ms,
            "nan_pixels": saved.nan_pixels,
            "clipped_pixels": saved.clipped_pixels,
        }));
    } else {
        output::print(&format!(
            "{} {frames} frames of {width}x{height} in {:.1} s by {who}",
            args.output.display(),
            total_ms * 1e-3
        ));
    }
    Ok(ExitCode::SUCCESS)
}

/// The time steps that a film goes over.
struct Stepped {
    series: Vec<String>,
    first: u32,
    last: u32,
}

impl Stepped {
    fn count(&self) -> u32 {
        self.first.abs_diff(self.last).saturating_add(1)
    }
}

fn steps(args: &AnimateArgs, scene: &Scene) -> Result<Option<Stepped>, Finding> {
    let Some(steps) = args.steps else {
        return Ok(None);
    };
    let series = scene.series();
    let Some(most) = series.iter().map(|(_, _, count)| *count).min() else {
        let message = "no volume of the graph has several time steps";
        return Err(Finding::error("no-time", message).help("leave `--steps` out"));
    };
    let (first, last) = match steps {
        Steps::All => (0, most - 1),
        Steps::Between(first, last) => (first, last),
    };
    if first.max(last) >= most {
        let message = format!(
            "there is no time step {}: there are {most}",
            first.max(last)
        );
        return Err(
            Finding::error("no-time", message).help(format!("name steps of 0 to {}", most - 1))
        );
    }
    Ok(Some(Stepped {
        series: series.iter().map(|(name, ..)| (*name).to_owned()).collect(),
        first,
        last,
    }))
}

fn film(path: &CameraPath, plan: &Plan, frames: u32, steps: Option<&Stepped>) -> Film {
    let film = Film::new(path, plan, frames);
    match steps {
        Some(steps) => {
            let series: Vec<&str> = steps.series.iter().map(String::as_str).collect();
            film.over_steps(&series, steps.first, steps.last)
        }
        None => film,
    }
}

fn draw(film: &Film, session: &mut Session, target: &mut Target) -> Result<(), Findings> {
    let bars = Bars::new();
    let frames = film.frames().len() as u64;
    let mut hazards = Findings::new();
    let drawn = film.render(
        session,
        &bars,
        |frame, picture, found| -> Result<(), Findings> {
            // What is wrong with one frame mostly is with all.
            if hazards.is_empty() {
                hazards = found.clone();
            }
            target.push(frame, &picture)?;
            bars.count("drawing frames", u64::from(frame) + 1, frames);
            Ok(())
        },
    );
    bars.clear();
    output::report_warnings(&hazards);
    drawn
}

/// Draws on the processor, for there is no adapter, and says who did.
fn draw_without_adapter(
    size: [u32; 2],
    scene: &Scene,
    target: &mut Target,
    film: impl FnOnce(&Plan) -> Film,
) -> Result<String, Findings> {
    scene.check_color_output()?;
    let bars = Bars::new();
    let film = film(&plan_without_device(scene, size)?);
    let frames = film.frames().len() as u64;
    let mut by = String::new();
    let mut set = None;
    for (number, frame) in (0..).zip(film.frames()) {
        let (scene, plan) = match set.take() {
            Some((sets, scene, plan)) if sets == &frame.sets => (scene, plan),
            _ => {
                let scene = scene.with_sets(&frame.sets)?;
                let plan = plan_without_device(&scene, size)?;
                (scene, plan)
            }
        };
        let view = View {
            camera: frame.camera,
            ..plan.view()
        };
        let (mut picture, who): (Picture, _) = software::draw(&plan, &view)?;
        picture.metadata = metadata::of(&scene, &plan, &view, &who);
        by = who.to_string();
        target.push(number, &picture)?;
        bars.count("drawing frames", u64::from(number) + 1, frames);
        set = Some((&frame.sets, scene, plan));
    }
    bars.clear();
    Ok(by)
}
