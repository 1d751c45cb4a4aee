//! Edits of a transfer function in a live session: what they have made anew, and how long each of it takes.
//!
//! A file in a folder of its own takes the place of the graph's transfer function. Each edit saves it with another scalar
//! from which on it absorbs, and is applied as a save is that `volgraph watch` sees: so what is empty changes each time.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

use volgraph::{
    Change, ChangeReport, Finding, Findings, Outcome, ParamOverride, Session, SessionOptions,
};
use volgraph_gpu::Gpu;
use volgraph_measure::timing::Summary;

use crate::args::SceneArgs;
use crate::commands::load;

/// The share of the scalars that the first edit leaves empty, and how much more the last one does.
const EMPTY: (f64, f64) = (0.25, 0.5);

/// The view of which a frame is little but what an edit has made anew.
const SMALL: [u32; 2] = [8, 8];

/// What edits took.
#[derive(Debug, Serialize)]
pub struct Edits {
    /// The source that was edited.
    pub transfer: String,
    /// Milliseconds of volgraph's own work, on the processor: all but frames and drivers' building of pipelines.
    pub own_ms: Summary,
    /// Milliseconds from the save to the picture in memory.
    pub total_ms: Summary,
    /// Milliseconds of the frame after an edit where it has 8² pixels: of tables and maps that are made anew.
    pub anew_ms: Summary,
    /// How much longer such a frame takes than without leaps over what is empty: the map of distances. Of each edit, in turn;
    /// `None` where the graph has none.
    pub distance_map_ms: Option<Summary>,
    /// Milliseconds on the device of each kind of node that an edit has run. Software devices tell no times that hold.
    pub device_ms: BTreeMap<String, Summary>,
}

/// Edits the first transfer function of a graph so many times.
///
/// # Errors
/// Where it has none, and what the graph refuses.
pub fn run(
    scene_args: &SceneArgs,
    edits: u32,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
) -> anyhow::Result<Edits> {
    let scene = load(scene_args)?;
    let mut sources = scene.desc.sources.iter();
    let Some((transfer, _)) = sources.find(|(_, source)| source.kind == "transfer") else {
        return Err(failed("the graph has no transfer function").into());
    };
    let transfer = transfer.to_string();
    let folder = tempfile::tempdir().map_err(|error| failed(&error.to_string()))?;
    let file = fs::canonicalize(folder.path()).map_err(|error| failed(&error.to_string()))?;
    let file = file.join("edited.ron");
    write(&file, 0.0)?;
    // A path may hold what a graph's text has a meaning for.
    let path = serde_json::to_string(&file)?;
    let set = format!("{transfer}.path={path}");
    let open = |size: [u32; 2], sets: &[&str]| -> anyhow::Result<Session> {
        let mut edited = scene_args.clone();
        for set in std::iter::once(set.as_str()).chain(sets.iter().copied()) {
            let set = ParamOverride::parse(set);
            edited.set.push(set.map_err(|why| failed(&why))?);
        }
        let options = SessionOptions {
            size,
            ..options.clone()
        };
        let mut session = Session::start(load(&edited)?, Arc::clone(gpu), &options)?;
        session.draw()?;
        Ok(session)
    };
    let mut whole = open(options.size, &[])?;
    let mut small = open(SMALL, &[])?;
    let leaping = {
        let mut nodes = whole.plan().graph.nodes.iter();
        let has_map = nodes.any(|node| node.kind_name() == "distance_map");
        let mut nodes = whole.plan().graph.nodes.iter();
        let raycast = nodes.find(|node| node.kind_name() == "raycast");
        raycast.filter(|_| has_map).map(|node| node.name.clone())
    };
    let mut walking = match leaping {
        Some(node) => Some(open(SMALL, &[&format!("{node}.slots.traverse=uniform")])?),
        None => None,
    };
    let mut device_ms: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let [mut own_ms, mut total_ms, mut anew_ms, mut map_ms] = [const { Vec::new() }; 4];
    for number in 1..=edits {
        write(&file, f64::from(number) / f64::from(edits))?;
        let report = edit(&mut whole, &file)?;
        own_ms.push(report.stages.own_ms());
        total_ms.push(report.stages.total_ms());
        for node in report.frame.nodes.iter().filter(|node| node.ran) {
            if let Some(ms) = node.gpu_ms.filter(|_| whole.adapter().class != "software") {
                device_ms.entry(node.kind.clone()).or_default().push(ms);
            }
        }
        let anew = edit(&mut small, &file)?.stages.draw_ms;
        anew_ms.push(anew);
        if let Some(walking) = &mut walking {
            map_ms.push(anew - edit(walking, &file)?.stages.draw_ms);
        }
    }
    let device_ms = device_ms.into_iter();
    let device_ms = device_ms.map(|(kind, all)| Ok((kind, Summary::of(&all)?)));
    Ok(Edits {
        transfer,
        own_ms: Summary::of(&own_ms)?,
        total_ms: Summary::of(&total_ms)?,
        anew_ms: Summary::of(&anew_ms)?,
        distance_map_ms: Summary::of(&map_ms).ok(),
        device_ms: device_ms.collect::<anyhow::Result<_>>()?,
    })
}

/// Has a session see that a file was saved.
fn edit(session: &mut Session, file: &Path) -> Result<ChangeReport, Findings> {
    let change = Change::Files([file.to_path_buf()].into());
    match session.apply(&change).map_err(|refused| refused.findings)? {
        Outcome::Drawn(drawn) => Ok(drawn.report),
        Outcome::Unchanged => Err(failed("the picture does not depend on it")),
    }
}

/// A transfer function that absorbs from a scalar on.
fn write(file: &Path, share: f64) -> Result<(), Findings> {
    let from = EMPTY.0 + EMPTY.1 * share;
    let text = format!(
        "(domain: normalised, color: [(0, (0.9, 0.5, 0.2)), (1, (0.9, 0.9, 0.9))], opacity: [(0, 0), ({from}, 0), (1, 0.5)])"
    );
    fs::write(file, text).map_err(|error| failed(&error.to_string()))
}

fn failed(why: &str) -> Findings {
    let message = format!("no transfer function can be edited: {why}");
    Finding::error("bench-edits", message)
        .help("name a graph whose picture depends on a source `transfer`")
        .into()
}

impl Edits {
    /// As lines for people.
    pub fn words(&self) -> String {
        let of = |ms: &Summary| format!("{:.1} ms ({:.1} to {:.1})", ms.median, ms.min, ms.max);
        let mut lines = vec![format!(
            "{} edits of the transfer function `{}`, medians: picture after {}, of which volgraph's own work {}; tables and maps anew {}",
            self.total_ms.n,
            self.transfer,
            of(&self.total_ms),
            of(&self.own_ms),
            of(&self.anew_ms),
        )];
        lines.extend(
            self.distance_map_ms
                .iter()
                .map(|ms| format!("  of it the map of distances {}", of(ms))),
        );
        let nodes = self.device_ms.iter();
        lines.extend(nodes.map(|(kind, ms)| format!("  on the device: {kind} {}", of(ms))));
        lines.join("\n")
    }
}
