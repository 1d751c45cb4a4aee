//! Other renderers in turn with volgraph, on the scene of the graph `comparison`.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

use volgraph::bench::{
    BenchStand, Entry, PEER_JOBS, PEER_VOLUMES, PeerJob, PeerRound, PeerRow, PeerWork, Rotation,
    peer_times,
};
use volgraph::methods::{Frames, Yardstick};
use volgraph::truth::plan_without_device;
use volgraph::{
    Finding, Findings, Overrides, ParamOverride, Picture, Scene, Session, SessionOptions,
    TruthOptions, registry,
};
use volgraph_measure::timing::Summary;
use volgraph_picture::srgb::srgb_from_linear;

use super::Bench;
use super::report::Writer;
use crate::commands::reference::Rows;
use crate::output;

/// The harness's width and height.
const SIZE: [u32; 2] = [512, 512];
/// Frames of each renderer in a round.
const FRAMES: u32 = 3;
/// Far below the errors that are told.
const TOLERANCE: f64 = 1e-4;

pub fn run(bench: &Bench<'_>, folder: &Path, writer: &mut Writer) -> Result<(), Findings> {
    let jobs_of = |work: PeerWork, volume: &str| -> Vec<&PeerJob> {
        let jobs = PEER_JOBS.iter().filter(|job| job.work == work);
        jobs.filter(|job| bench.args.is_wanted(&format!("{}/{volume}", job.name())))
            .collect()
    };
    let pictures = tempfile::tempdir().map_err(|error| failed(&error.to_string()))?;
    for (volume, field) in PEER_VOLUMES {
        for work in PeerWork::ALL {
            let jobs = jobs_of(work, volume);
            if jobs.is_empty() {
                continue;
            }
            let scene = scene(bench, field, work, &[])?;
            let truth = work
                .most_error()
                .map(|_| truth(bench, &scene))
                .transpose()?;
            let mut method = method(bench, field, work, truth.as_ref())?;
            for job in jobs {
                let png = pictures.path().join("peer.png");
                let row = row(
                    bench,
                    folder,
                    job,
                    volume,
                    &mut method,
                    truth.as_ref(),
                    &png,
                )?;
                bench.bars.clear();
                if !bench.args.json {
                    output::print(&words(&row));
                }
                writer.report.peers.push(row);
                writer.write()?;
            }
        }
    }
    Ok(())
}

/// The harness's scene.
fn scene(bench: &Bench<'_>, field: &str, work: PeerWork, more: &[&str]) -> Result<Scene, Findings> {
    let field = format!("volume.field={field}");
    let sets = std::iter::once(field.as_str())
        .chain(work.sets().iter().copied())
        .chain(more.iter().copied());
    let params = sets.map(|set| ParamOverride::parse(set).map_err(|why| failed(&why)));
    let overrides = Overrides {
        params: params.collect::<Result<_, _>>()?,
        ..Overrides::default()
    };
    let shaders = bench.args.shaders.folders();
    Scene::load(
        Path::new("embedded:/graphs/comparison.ron"),
        &overrides,
        &shaders,
        registry(),
        &bench.bars,
    )
}

fn truth(bench: &Bench<'_>, scene: &Scene) -> Result<Yardstick, Findings> {
    let plan = plan_without_device(scene, SIZE)?;
    let options = TruthOptions {
        tolerance: TOLERANCE,
        ..TruthOptions::default()
    };
    let truth = Yardstick::reference(&plan, &plan.view(), &options, &Rows(&bench.bars));
    bench.bars.clear();
    truth
}

/// What volgraph draws with.
struct Method {
    words: String,
    error: Option<f64>,
    entry: Entry,
    stand: BenchStand,
}

/// The fastest of the candidates that is accurate enough.
fn method(
    bench: &Bench<'_>,
    field: &str,
    work: PeerWork,
    truth: Option<&Yardstick>,
) -> Result<Method, Findings> {
    let session = SessionOptions {
        size: SIZE,
        ..bench.options.clone()
    };
    // The harness turns by one degree from frame to frame.
    let rotation = Rotation {
        turn_degrees: 1.0,
        degrees: (1..=FRAMES).map(f64::from).collect(),
    };
    let mut best: Option<(f64, Method)> = None;
    for sets in work.candidates() {
        let scene = scene(bench, field, work, sets)?;
        let error = match truth {
            Some(truth) => {
                let mut session = Session::start(scene.clone(), Arc::clone(&bench.gpu), &session)?;
                let (picture, _) = session.render_checked()?;
                Some(truth.errors(&picture)?.core_rmse_8bit * 255.0)
            }
            None => None,
        };
        if error
            .zip(work.most_error())
            .is_some_and(|(error, most)| error > most)
        {
            continue;
        }
        let mut stand = BenchStand::new(rotation.clone());
        let mut entry = Entry::new(scene, &bench.gpu, &session)?;
        let times = (0..=FRAMES).map(|number| stand.frame(&mut entry, number));
        let times = times.collect::<Result<Vec<_>, _>>()?;
        let median = Summary::of(&times[1..])
            .map_err(|error| failed(&error.to_string()))?
            .median;
        stand.start();
        if best.as_ref().is_none_or(|(fastest, _)| median < *fastest) {
            let words = sets
                .iter()
                .map(|set| {
                    set.trim_start_matches("image.")
                        .trim_start_matches("slots.")
                })
                .collect::<Vec<_>>()
                .join(" ");
            best = Some((
                median,
                Method {
                    words,
                    error,
                    entry,
                    stand,
                },
            ));
        }
    }
    let best = best.ok_or_else(|| failed("none of volgraph's methods is accurate enough"))?;
    Ok(best.1)
}

fn row(
    bench: &Bench<'_>,
    folder: &Path,
    job: &PeerJob,
    volume: &str,
    method: &mut Method,
    truth: Option<&Yardstick>,
    png: &Path,
) -> Result<PeerRow, Findings> {
    let mut row = PeerRow {
        volume: volume.to_owned(),
        job: job.clone(),
        error: None,
        frame_ms: None,
        ratio: None,
        method: method.words.clone(),
        method_error: method.error,
        method_ms: None,
        failed: None,
    };
    let rounds = bench
        .args
        .frames
        .map_or(3, |frames| frames.div_ceil(FRAMES));
    let mut measured = Vec::new();
    let began = Instant::now();
    for round in 0..rounds {
        bench.bars.count(
            &format!("timing {}", job.name()),
            u64::from(round),
            u64::from(rounds),
        );
        let theirs = match work(bench, folder, job, volume, png) {
            Ok(times) => times,
            Err(why) => {
                row.failed = Some(why);
                return Ok(row);
            }
        };
        let ours = (0..FRAMES).map(|number| method.stand.frame(&mut method.entry, number));
        measured.push(PeerRound {
            peer_ms: theirs,
            own_ms: ours.collect::<Result<Vec<_>, _>>()?,
        });
        if began.elapsed().as_secs_f64() > bench.args.seconds {
            break;
        }
    }
    row.take(&measured);
    // Of the box between voxel centres there is no truth here.
    if let Some(truth) = truth.filter(|_| !job.is_between_centres()) {
        row.error = error_of(png, truth);
    }
    Ok(row)
}

/// Runs a worker.
fn work(
    bench: &Bench<'_>,
    folder: &Path,
    job: &PeerJob,
    volume: &str,
    png: &Path,
) -> Result<Vec<f64>, String> {
    let request = job.request(volume, FRAMES, &png.display().to_string());
    let output = Command::new(&bench.args.python)
        .arg(folder.join("worker.py"))
        .arg(request.to_string())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("{} cannot be run: {error}", bench.args.python.display()))?;
    peer_times(&String::from_utf8_lossy(&output.stdout)).map_err(|why| {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said
            .lines()
            .rev()
            .find(|line| !line.trim().is_empty())
            .unwrap_or_default();
        format!("{why}; it ended with {}: {last}", output.status)
    })
}

/// The error of a renderer's picture in 8-bit steps. Its bytes are linear, and reading them has taken them for sRGB.
fn error_of(png: &Path, truth: &Yardstick) -> Option<f64> {
    let mut picture = Picture::load(png).ok()?;
    for color in &mut picture.color {
        for component in &mut color[..3] {
            #[expect(clippy::cast_possible_truncation, reason = "bytes")]
            let byte = srgb_from_linear(f64::from(*component)) as f32;
            *component = byte;
        }
    }
    Some(truth.errors(&picture).ok()?.core_rmse * 255.0)
}

fn failed(why: &str) -> Finding {
    Finding::error(
        "peers",
        format!("other renderers cannot be compared with: {why}"),
    )
}

/// A row as a line.
fn words(row: &PeerRow) -> String {
    let head = format!("{:<5} {:<32}", row.volume, row.job.name());
    match (&row.failed, row.frame_ms, row.method_ms, row.ratio) {
        (None, Some(theirs), Some(ours), Some(ratio)) => format!(
            "{head} {:>8.1} ms, error {}: {:.2} times as long as volgraph's {:.1} ms, error {} ({})",
            theirs.median,
            error_words(row.error),
            ratio.median,
            ours.median,
            error_words(row.method_error),
            row.method
        ),
        (why, ..) => format!("{head} not timed: {}", why.as_deref().unwrap_or_default()),
    }
}

/// An error, where there is one.
pub fn error_words(error: Option<f64>) -> String {
    error.map_or_else(|| "–".to_owned(), |error| format!("{error:.2}"))
}
