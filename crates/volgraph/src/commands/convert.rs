//! `volgraph convert`: a volume into a file of another format, cropped, resampled or in another type where asked for.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde_json::json;
use volgraph_formats::{LoadOptions, WriteOptions, Written, write};
use volgraph_volume::edit::{Converted, Filter, Target, Watch, convert, crop, resample};
use volgraph_volume::{Volume, VolumeError};

use super::volume_error;
use crate::args::{ConvertArgs, WriteArgs};
use crate::output;
use crate::progress::Bars;
use crate::signals::Interrupt;

pub fn run(args: &ConvertArgs) -> anyhow::Result<ExitCode> {
    let start = Instant::now();
    let bars = Arc::new(Bars::new());
    let interrupt = Interrupt::watch();
    let done = work(args, &bars, &interrupt);
    bars.clear();
    interrupt.end_as_the_signal_does();
    let (volume, converted, written) = done.map_err(volume_error)?;
    tell(
        &args.output,
        &args.write,
        &volume,
        &written,
        converted.as_ref(),
        start,
    );
    Ok(ExitCode::SUCCESS)
}

type Done = (Volume, Option<Converted>, Written);

fn work(args: &ConvertArgs, bars: &Arc<Bars>, interrupt: &Interrupt) -> Result<Done, VolumeError> {
    let (shown, asked) = (Arc::clone(bars), interrupt.clone());
    let what = format!("reading {}", args.volume.volume.display());
    let options = LoadOptions {
        progress: Some(Arc::new(move |done, total| {
            shown.update(&what, done, total);
            // Nothing is written yet.
            asked.end_if_asked();
        })),
        ..args.volume.options()
    };
    let mut volume = volgraph_formats::load(&args.volume.volume, &options)?;
    if let Some(cut) = args.crop {
        let watch = watch(bars, interrupt, "cropping".to_owned());
        volume = crop(&volume, cut.low, cut.dims, &watch)?;
    }
    let target = args.resample.map(Target::Dims).or(args
        .spacing
        .map(|spacing| Target::Spacing(spacing.0.into())));
    if let Some(target) = target {
        let filter = args
            .filter
            .map_or_else(|| Filter::for_values(&volume.about().values), Filter::from);
        let watch = watch(bars, interrupt, "resampling".to_owned());
        volume = resample(&volume, target, filter, &watch)?;
    }
    let mut converted = None;
    if let Some(to) = args.to {
        let watch = watch(bars, interrupt, "converting".to_owned());
        let window = args.window.map(|window| (window.0, window.1));
        let (other, what) = convert(&volume, to, window, &watch)?;
        (volume, converted) = (other, Some(what));
    }
    let written = write_volume(&volume, &args.output, &args.write, bars, interrupt)?;
    Ok((volume, converted, written))
}

/// Writes a volume as the arguments say, with a progress bar.
pub fn write_volume(
    volume: &Volume,
    output: &Path,
    args: &WriteArgs,
    bars: &Arc<Bars>,
    interrupt: &Interrupt,
) -> Result<Written, VolumeError> {
    let options = WriteOptions {
        compression: args.compress,
        chunk: args.chunk,
        levels: args.levels,
        overwrite: args.force,
        watch: watch(bars, interrupt, format!("writing {}", output.display())),
        ..WriteOptions::default()
    };
    write(volume, output, &options)
}

/// Work that a bar shows and an interrupt stops.
pub fn watch(bars: &Arc<Bars>, interrupt: &Interrupt, name: String) -> Watch {
    let shown = Arc::clone(bars);
    Watch {
        progress: Some(Arc::new(move |done, total| {
            shown.update(&name, done, total);
        })),
        interrupt: Some(interrupt.flag()),
    }
}

/// Says what was written.
pub fn tell(
    output: &Path,
    args: &WriteArgs,
    volume: &Volume,
    written: &Written,
    converted: Option<&Converted>,
    start: Instant,
) {
    for warning in volume.warnings().iter().chain(&written.warnings) {
        output::warn(warning);
    }
    let [x, y, z] = volume.grid().dims;
    let ty = volume.voxels().scalar_type();
    let seconds = start.elapsed().as_secs_f64();
    if args.json {
        output::print_json(&json!({
            "output": output.display().to_string(),
            "files": written.files,
            "bytes": written.bytes,
            "dims": [x, y, z],
            "type": ty.name(),
            "clamped": converted.map(|it| it.clamped),
            "rounded": converted.map(|it| it.rounded),
            "not_numbers": converted.map(|it| it.not_numbers),
            "seconds": seconds,
        }));
        return;
    }
    let mut lost = Vec::new();
    if let Some(converted) = converted {
        for (count, what) in [
            (converted.clamped, "clamped to the type's range"),
            (converted.rounded, "rounded"),
            (converted.not_numbers, "that were no numbers"),
        ] {
            if count > 0 {
                lost.push(format!("; {count} voxels {what}"));
            }
        }
    }
    output::print(&format!(
        "{} {x}x{y}x{z} {ty}, {} bytes in {seconds:.1} s{}",
        output.display(),
        written.bytes,
        lost.concat()
    ));
}
