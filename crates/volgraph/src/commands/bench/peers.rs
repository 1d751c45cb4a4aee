//! Other renderers in turn with volgraph, on the scene of the graph `comparison`.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use volgraph::bench::{
    CHART_JOBS, PEER_JOBS, PEER_VOLUMES, PeerJob, PeerRound, PeerRow, PeerWork, peer_times,
};
use volgraph::methods::Yardstick;
use volgraph::{Finding, Findings, Picture, Place};
use volgraph_picture::srgb::srgb_from_linear;

use super::Bench;
use super::peer_methods::{FRAMES, Method, Truths, fastest, methods, take_turn};
use super::report::Writer;
use crate::output;

pub fn run(bench: &Bench<'_>, folder: &Path, writer: &mut Writer) -> Result<(), Findings> {
    let pictures = tempfile::tempdir().map_err(|error| failed(&error.to_string()))?;
    check_filters(bench)?;
    for (volume, field) in PEER_VOLUMES {
        for work in PeerWork::ALL {
            let jobs = jobs_of(bench, work, volume);
            if jobs.is_empty() {
                continue;
            }
            let truths = Truths::of(bench, field, work, &jobs)?;
            let mut methods = methods(bench, field, work, truths.whole.as_ref())?;
            let best = fastest(&methods, work)
                .ok_or_else(|| failed("none of volgraph's methods is accurate enough"))?;
            if bench.args.chart.is_none() {
                methods = vec![methods.swap_remove(best)];
            }
            let best = if methods.len() == 1 { 0 } else { best };
            for (number, job) in jobs.into_iter().enumerate() {
                // One for each: what a worker leaves out is not another's.
                let name = format!("{}-{volume}.png", job.name().replace('/', "-"));
                let png = pictures.path().join(name);
                let row = row(
                    bench,
                    folder,
                    job,
                    volume,
                    &mut methods[best],
                    &truths,
                    &png,
                )?;
                bench.bars.clear();
                if !bench.args.json {
                    output::print(&words(&row));
                }
                writer.report.peers.push(row);
                // volgraph's frames are spread over the same time as those of the others.
                if bench.args.chart.is_some() && number % 2 == 0 {
                    bench.bars.count("timing volgraph's methods", 0, 1);
                    take_turn(&mut methods, number % 4 == 0)?;
                }
                writer.write()?;
            }
            if bench.args.chart.is_some() {
                let points = methods.iter().map(|method| method.point(volume, work));
                let points = points.collect::<Result<Vec<_>, _>>()?;
                writer.report.points.extend(points);
                writer.write()?;
            }
        }
    }
    if let Some(file) = &bench.args.chart {
        bench.bars.clear();
        super::peer_chart::write(&writer.report, file)?;
        if !bench.args.json {
            output::print(&format!("{}", file.display()));
        }
    }
    Ok(())
}

/// Refuses filters that leave no renderer.
fn check_filters(bench: &Bench<'_>) -> Result<(), Finding> {
    let all = || {
        let each = PEER_VOLUMES.iter();
        each.flat_map(|(volume, _)| PeerWork::ALL.map(|work| (work, *volume)))
    };
    if all().any(|(work, volume)| !jobs_of(bench, work, volume).is_empty()) {
        return Ok(());
    }
    let jobs = PEER_JOBS.iter().chain(&CHART_JOBS);
    let names: Vec<String> = jobs
        .flat_map(|job| PEER_VOLUMES.map(|(volume, _)| format!("`{}/{volume}`", job.name())))
        .collect();
    Err(failed("--filter leaves none")
        .at(Place::whole_file("--filter"))
        .help(format!("write a part of one of {}", names.join(", "))))
}

/// The jobs that are asked for, by renderer.
fn jobs_of(bench: &Bench<'_>, work: PeerWork, volume: &str) -> Vec<&'static PeerJob> {
    // Isosurfaces have no errors: a chart has nothing to show of them.
    let is_charted = bench.args.chart.is_some();
    let more = is_charted.then_some(&CHART_JOBS).into_iter().flatten();
    let jobs = PEER_JOBS.iter().chain(more);
    let jobs = jobs.filter(|job| job.work == work && (!is_charted || work.most_error().is_some()));
    jobs.filter(|job| bench.args.is_wanted(&format!("{}/{volume}", job.name())))
        .collect()
}

fn row(
    bench: &Bench<'_>,
    folder: &Path,
    job: &PeerJob,
    volume: &str,
    method: &mut Method,
    truths: &Truths,
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
        let ours = (0..FRAMES).map(|_| method.frame());
        measured.push(PeerRound {
            peer_ms: theirs,
            own_ms: ours.collect::<Result<Vec<_>, _>>()?,
        });
        if began.elapsed().as_secs_f64() > bench.args.seconds {
            break;
        }
    }
    row.take(&measured);
    if let Some(truth) = truths.of_job(job) {
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

pub fn failed(why: &str) -> Finding {
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
