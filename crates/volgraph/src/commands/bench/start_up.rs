//! How long it takes from the program's start to its first picture, and what it holds then.
//!
//! The program starts itself, with caches in an empty folder: the first start finds none (volgraph's own and those of
//! drivers that keep theirs where XDG_CACHE_HOME says, as Mesa does), the others find what it left.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Instant;

use serde::Serialize;
use serde_json::Value;
use volgraph::{Finding, Findings};
use volgraph_measure::timing::Summary;

use super::Bench;
use super::report::Writer;

/// Starts with what the first one left.
const WARM: usize = 3;

/// Starts of a graph.
#[derive(Debug, Serialize)]
pub struct StartUp {
    /// The graph.
    pub graph: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Milliseconds to the first picture with empty caches.
    pub cold_ms: f64,
    /// The same with filled ones.
    pub warm_ms: Summary,
    /// Milliseconds of the whole program with filled caches, from before it is started until it has ended.
    pub warm_process_ms: Summary,
    /// The most that a warm start held in the main memory when its first picture was there; `None` where the system does
    /// not say.
    pub peak_resident_bytes: Option<u64>,
    /// Textures and buffers on the device.
    pub device_bytes: u64,
}

/// What one start says of itself.
struct Start {
    first_picture_ms: f64,
    process_ms: f64,
    peak_resident_bytes: Option<u64>,
    device_bytes: u64,
}

pub fn run(bench: &Bench<'_>, writer: &mut Writer) -> Result<(), Findings> {
    let mut graphs = bench.args.graphs.clone();
    if graphs.is_empty() {
        graphs.push(PathBuf::from("quickstart"));
    }
    for graph in graphs {
        for size in bench.args.sizes() {
            let cache = tempfile::tempdir().map_err(|error| failed(&error.to_string()))?;
            let start = |_| start(bench, &graph, size, cache.path());
            let cold = start(0)?;
            let warm = (0..WARM).map(start).collect::<Result<Vec<_>, _>>()?;
            let summary =
                |times: Vec<f64>| Summary::of(&times).map_err(|error| failed(&error.to_string()));
            writer.report.start_up.push(StartUp {
                graph: graph.display().to_string(),
                size,
                cold_ms: cold.first_picture_ms,
                warm_ms: summary(warm.iter().map(|start| start.first_picture_ms).collect())?,
                warm_process_ms: summary(warm.iter().map(|start| start.process_ms).collect())?,
                peak_resident_bytes: warm
                    .iter()
                    .filter_map(|start| start.peak_resident_bytes)
                    .max(),
                device_bytes: cold.device_bytes,
            });
            writer.write()?;
        }
    }
    Ok(())
}

fn start(
    bench: &Bench<'_>,
    graph: &std::path::Path,
    [width, height]: [u32; 2],
    cache: &std::path::Path,
) -> Result<Start, Findings> {
    let program = std::env::current_exe().map_err(|error| failed(&error.to_string()))?;
    let mut command = Command::new(program);
    command.arg("bench").arg(graph);
    command.args(["--frames", "1", "--warm-up", "0", "--no-limit", "--json"]);
    command.arg("--size").arg(format!("{width}x{height}"));
    for (option, folders) in [
        ("--data", &bench.args.data.data),
        ("--shaders", &bench.args.shaders.shaders),
    ] {
        for folder in folders {
            command.arg(option).arg(folder);
        }
    }
    for volume in &bench.args.volume {
        command.arg("--volume").arg(volume);
    }
    if let Some(most) = bench.args.max_resource_gib {
        command.arg("--max-resource-gib").arg(most.to_string());
    }
    if let Some(adapter) = &bench.args.adapter {
        command.arg("--adapter").arg(adapter);
    }
    command
        .env("XDG_CACHE_HOME", cache)
        .env("VOLGRAPH_CACHE", cache.join("volgraph"));
    command
        .env_remove("MESA_SHADER_CACHE_DIR")
        .stdin(Stdio::null());
    let began = Instant::now();
    let output = command
        .output()
        .map_err(|error| failed(&error.to_string()))?;
    let process_ms = began.elapsed().as_secs_f64() * 1e3;
    if !output.status.success() {
        return Err(failed(String::from_utf8_lossy(&output.stderr).trim()).into());
    }
    let said: Value =
        serde_json::from_slice(&output.stdout).map_err(|error| failed(&error.to_string()))?;
    Ok(Start {
        first_picture_ms: said["first_picture_ms"].as_f64().unwrap_or(process_ms),
        process_ms,
        peak_resident_bytes: said["peak_resident_bytes"].as_u64(),
        device_bytes: said["device_bytes"].as_u64().unwrap_or(0),
    })
}

fn failed(why: &str) -> Finding {
    Finding::error(
        "start-up",
        format!("the program could not be started again: {why}"),
    )
}
