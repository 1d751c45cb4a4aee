//! The papers' tables: each technique on each volume at each size.

use std::time::Instant;

use volgraph::bench::{Row, Subject, Table, TableOptions, run_table};
use volgraph::{Findings, Overrides, SessionOptions};

use super::Bench;
use super::report::{Volume, Writer};
use crate::output;

pub fn run(bench: &Bench<'_>, writer: &mut Writer) -> Result<(), Findings> {
    let args = bench.args;
    let data = Overrides {
        data: args.data.data.clone(),
        ..Overrides::default()
    };
    let shaders = args.shaders.folders();
    let techniques = bench.techniques(&[])?;
    let rotation = args.rotation();
    writer.report.step_voxels = args.step;
    writer.report.views = rotation.degrees.len();
    writer.report.turn_degrees = rotation.turn_degrees;
    let mut subjects = Vec::new();
    for volume in args.volumes() {
        let subject = Subject::load(&volume, &data, &shaders, &bench.bars)?;
        writer.report.volumes.push(Volume {
            name: subject.name.clone(),
            dims: subject.dims,
            summary: subject.summary.clone(),
        });
        subjects.push(subject);
    }
    for technique in &techniques {
        writer.report.name(&technique.name, &technique.doc);
    }
    let started = Instant::now();
    let all = subjects.len() * args.sizes().len() * techniques.len();
    let mut done = 0;
    for subject in &subjects {
        for size in args.sizes() {
            for technique in &techniques {
                bench
                    .bars
                    .count("timing techniques", done as u64, all as u64);
                // What the others have left is shared out again.
                let left = args.seconds - started.elapsed().as_secs_f64();
                let options = TableOptions {
                    rotation: rotation.clone(),
                    seconds: left.max(0.0) / (all - done) as f64,
                    warm_up: args.warm_up.unwrap_or(1),
                };
                let session = SessionOptions {
                    size,
                    ..bench.options.clone()
                };
                let stages: Vec<&str> = args.stage.iter().map(String::as_str).collect();
                let rows = match technique.scene(subject, args.step, &shaders) {
                    Ok(scene) => run_table(&scene, &stages, &bench.gpu, &session, &options),
                    Err(why) => {
                        let refused = |stage: &&str| Row::refused(stage, why.to_string());
                        stages.iter().map(refused).collect()
                    }
                };
                let table = Table {
                    volume: subject.name.clone(),
                    size,
                    technique: technique.name.clone(),
                    rows,
                };
                if !args.json {
                    bench.bars.clear();
                    output::print(&words(&table));
                }
                writer.report.tables.push(table);
                writer.write()?;
                done += 1;
            }
        }
    }
    Ok(())
}

/// A table as lines.
pub fn words(table: &Table) -> String {
    let [width, height] = table.size;
    let head = format!("{} {width}x{height} {}", table.volume, table.technique);
    let rows = table
        .rows
        .iter()
        .map(|row| format!("{head:<48} {:<9} {}", row.stage, row_words(row)));
    rows.collect::<Vec<_>>().join("\n")
}

fn row_words(row: &Row) -> String {
    let (Some([min, average, max]), Some(frame), Some(to_limit)) =
        (row.fps, row.frame_ms, row.to_limit)
    else {
        return format!("refused: {}", row.refused.as_deref().unwrap_or_default());
    };
    let net = row
        .to_limit_net
        .map_or_else(|| "-".to_owned(), |net| format!("{net:.2}"));
    format!(
        "{min:.2} {average:.2} {max:.2} fps, {:.1} ms, {:.2} of the limit ({net} net), {} frames",
        frame.median, to_limit.median, frame.n
    )
}
