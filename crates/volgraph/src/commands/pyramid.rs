//! `volgraph pyramid`: the coarser levels of a volume that is larger than memory, and what each of them loses.

use std::fmt::Write as _;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde_json::{Value, json};
use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build, pyramid_path};

use super::convert::watch;
use super::volume_error;
use crate::args::PyramidArgs;
use crate::output;
use crate::progress::Bars;
use crate::signals::Interrupt;

/// What a level is like.
struct Level {
    dims: [u32; 3],
    bricks: [u32; 3],
    /// Root mean square over all bricks, and the largest difference, from the finest level.
    rms: f64,
    max: f64,
}

pub fn run(args: &PyramidArgs) -> anyhow::Result<ExitCode> {
    let start = Instant::now();
    let source = &args.volume.volume;
    let folder = args.output.clone().unwrap_or_else(|| pyramid_path(source));
    let bars = Arc::new(Bars::new());
    let interrupt = Interrupt::watch();
    let options = BuildOptions {
        load: args.volume.options(),
        edge: args.edge,
        shard_chunks: args.shard,
        copy_level_0: args.copy,
        max_memory: args.memory << 20,
        overwrite: args.force,
        watch: watch(&bars, &interrupt, format!("building {}", folder.display())),
        ..BuildOptions::default()
    };
    let built = build(source, &folder, &options);
    bars.clear();
    interrupt.end_as_the_signal_does();
    let built = built.map_err(volume_error)?;
    let store = StoreOptions {
        load: args.volume.options(),
        ..StoreOptions::default()
    };
    let store = BrickStore::open(&built.folder, &store).map_err(volume_error)?;
    let levels: Vec<Level> = (0..store.levels().len())
        .map(|level| level_of(&store, level))
        .collect();
    let seconds = start.elapsed().as_secs_f64();
    if args.json {
        output::print_json(&json!({
            "folder": built.folder.display().to_string(),
            "levels": levels.iter().map(to_json).collect::<Vec<_>>(),
            "written": built.written,
            "seconds": seconds,
        }));
        return Ok(ExitCode::SUCCESS);
    }
    let mut text = format!("{} in {seconds:.1} s\n", built.folder.display());
    text.push_str("level  dims               bricks         rms error      largest\n");
    for (number, level) in levels.iter().enumerate() {
        let dims = level.dims.map(|n| n.to_string()).join("x");
        let bricks = level.bricks.map(|n| n.to_string()).join("x");
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "{number:<6} {dims:<18} {bricks:<14} {:<14.6} {:.6}",
            level.rms, level.max
        );
    }
    output::print(text.trim_end());
    Ok(ExitCode::SUCCESS)
}

fn level_of(store: &BrickStore, number: usize) -> Level {
    let level = &store.levels()[number];
    let [nx, ny, nz] = level.bricks;
    let (mut squares, mut max, mut count) = (0.0, 0.0_f64, 0.0);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let Some(info) = store.brick_info(number, [x, y, z]) else {
                    continue;
                };
                squares += info.rms_error.powi(2);
                max = max.max(info.max_error);
                count += 1.0;
            }
        }
    }
    let rms: f64 = squares / f64::max(count, 1.0);
    Level {
        dims: level.grid.dims,
        bricks: level.bricks,
        rms: rms.sqrt(),
        max,
    }
}

fn to_json(level: &Level) -> Value {
    json!({
        "dims": level.dims,
        "bricks": level.bricks,
        "rms_error": level.rms,
        "max_error": level.max,
    })
}
