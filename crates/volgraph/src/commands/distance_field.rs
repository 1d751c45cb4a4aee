//! `volgraph distance-field`: a mesh into a volume of signed distances, for isosurfaces and clip volumes.

use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use volgraph::{Finding, Findings};
use volgraph_mesh::{FieldOptions, Mesh, ReadOptions, Resolution, distance_field};

use super::convert::{tell, write_volume};
use super::volume_error;
use crate::args::{DistanceFieldArgs, InsideName};
use crate::output;
use crate::progress::Bars;
use crate::signals::Interrupt;

pub fn run(args: &DistanceFieldArgs) -> anyhow::Result<ExitCode> {
    let start = Instant::now();
    let of_mesh = |error| anyhow::Error::from(Findings::from(Finding::from(error)));
    let mesh = Mesh::read(&args.mesh, &ReadOptions::default()).map_err(of_mesh)?;
    let report = mesh.report();
    output::note(&format!("{}: {report}", args.mesh.display()));
    let bars = Arc::new(Bars::new());
    let interrupt = Interrupt::watch();
    let shown = Arc::clone(&bars);
    let resolution = match (args.dims, args.voxel) {
        (Some(dims), _) => Resolution::Dims(dims),
        (None, Some(size)) => Resolution::VoxelSize(size),
        (None, None) => Resolution::LongestAxis(args.longest),
    };
    let options = FieldOptions {
        resolution,
        margin: args.margin,
        band: args.band,
        sign: args.sign,
        positive_inside: args.inside == InsideName::Positive,
        up: args.up,
        progress: Some(Arc::new(move |done, total| {
            shown.count("computing distances", done, total);
        })),
        cancel: Some(interrupt.flag()),
        ..FieldOptions::default()
    };
    let field = distance_field(&mesh, &options);
    let written = field.map_err(of_mesh).and_then(|volume| {
        let written = write_volume(&volume, &args.output, &args.write, &bars, &interrupt);
        written
            .map(|written| (volume, written))
            .map_err(volume_error)
    });
    bars.clear();
    interrupt.end_as_the_signal_does();
    let (volume, written) = written?;
    tell(&args.output, &args.write, &volume, &written, None, start);
    Ok(ExitCode::SUCCESS)
}
