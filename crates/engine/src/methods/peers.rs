//! Other renderers' figures, from the table that a harness of theirs writes.
//!
//! The table is of tab separated values with a line of names. Read are `peer`, `mode`, `volume`, `step_vox`, `median_ms`,
//! `min_ms`, `max_ms`, `n` and `rmse8_core`; other columns are passed over. Rows without an error are of modes
//! that have no common truth, and rows without a time failed: both are left out. Errors are in units of an
//! 8-bit step, over red, green and blue of core pixels ([`core_pixels`](super::core_pixels)), of pictures with 8 bits a
//! component: rounding alone makes about 0.29 of them.
//!
//! Every row is shown in the chart of its scene or is counted there with the reason why not ([`ScenePeers`]).

use serde::{Deserialize, Serialize};
use volgraph_graph::GraphDesc;
use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

/// A renderer's figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Peer {
    /// The renderer and its way of drawing.
    pub name: String,
    /// What the harness calls its mode.
    pub mode: String,
    /// The harness's name of the volume.
    pub volume: String,
    /// Its step in voxels, or how it chooses one.
    pub step: String,
    /// Milliseconds of a frame, the median.
    pub median_ms: f64,
    /// The fastest.
    pub min_ms: f64,
    /// The slowest.
    pub max_ms: f64,
    /// Frames that were timed.
    pub frames: usize,
    /// Root of the mean squared error over core pixels, in 8-bit steps.
    pub core_rmse_8bit_steps: f64,
}

/// The peers of a table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Peers {
    /// The renderers, in the table's order.
    pub peers: Vec<Peer>,
    /// Rows without a time or an error.
    pub unmeasured: usize,
}

/// The peers that a chart can be held against.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ScenePeers {
    /// Those that drew the chart's scene, in the table's order.
    pub peers: Vec<Peer>,
    /// The table's other rows.
    pub left_out: Vec<LeftOut>,
}

/// Rows that a chart does not show.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// How many, one or more.
    pub rows: usize,
    /// The reason, said of rows.
    pub why: &'static str,
}

impl std::fmt::Display for LeftOut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let rows = if self.rows == 1 { "row" } else { "rows" };
        write!(f, "{} {rows} {}", self.rows, self.why)
    }
}

/// The columns that are read.
const COLUMNS: [&str; 9] = [
    "peer",
    "mode",
    "volume",
    "step_vox",
    "median_ms",
    "min_ms",
    "max_ms",
    "n",
    "rmse8_core",
];

/// A row as it is written: numbers may be missing.
#[derive(Deserialize)]
struct Row {
    peer: String,
    mode: String,
    volume: String,
    step_vox: String,
    median_ms: Option<f64>,
    min_ms: Option<f64>,
    max_ms: Option<f64>,
    n: Option<usize>,
    rmse8_core: Option<f64>,
}

impl Peers {
    /// Reads a table.
    ///
    /// # Errors
    /// `bad-peers`, with the line, for a table without these columns or with something else than numbers in them.
    pub fn parse(text: &str) -> Result<Self, Findings> {
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(b'\t')
            .quoting(false)
            .from_reader(text.as_bytes());
        let wrong = |why: String| {
            Finding::error(
                "bad-peers",
                format!("the table of peers is not right: {why}"),
            )
            .help(format!(
                "its columns are tab separated: {}",
                COLUMNS.join(", ")
            ))
        };
        let head = reader.headers().map_err(|error| wrong(error.to_string()))?;
        if let Some(missing) = COLUMNS
            .iter()
            .find(|column| head.iter().all(|name| name != **column))
        {
            return Err(wrong(format!("it has no column `{missing}`")).into());
        }
        let mut found = Self::default();
        for row in reader.deserialize::<Row>() {
            let row = row.map_err(|error| wrong(error.to_string()))?;
            let positive =
                |value: Option<f64>| value.filter(|value| value.is_finite() && *value > 0.0);
            let (Some(median_ms), Some(core_rmse)) =
                (positive(row.median_ms), positive(row.rmse8_core))
            else {
                found.unmeasured += 1;
                continue;
            };
            found.peers.push(Peer {
                name: row.peer,
                mode: row.mode,
                volume: row.volume,
                step: row.step_vox,
                median_ms,
                min_ms: row.min_ms.unwrap_or(median_ms),
                max_ms: row.max_ms.unwrap_or(median_ms),
                frames: row.n.unwrap_or(0),
                core_rmse_8bit_steps: core_rmse,
            });
        }
        Ok(found)
    }

    /// Those that drew the scene of a graph by emission and absorption, for a picture of this width and height; and why
    /// the others did not.
    #[must_use]
    pub fn of(&self, graph: &GraphDesc, size: [u32; 2]) -> ScenePeers {
        let scene = harness_volume(graph);
        // Errors in 8-bit steps cannot be told apart from those of another size.
        let reason = |peer: &Peer| match scene {
            None => Some("not of this graph's scene"),
            Some(_) if size != SIZE => Some("of pictures of 512 × 512 pixels"),
            Some(volume) if peer.volume != volume => Some("of another volume"),
            Some(_) if !MODES.contains(&peer.mode.as_str()) => {
                Some("not of emission and absorption")
            }
            Some(_) => None,
        };
        let mut found = ScenePeers::default();
        found.leave_out(self.unmeasured, "without a time or an error");
        for peer in &self.peers {
            match reason(peer) {
                Some(why) => found.leave_out(1, why),
                None => found.peers.push(peer.clone()),
            }
        }
        found
    }
}

impl ScenePeers {
    fn leave_out(&mut self, rows: usize, why: &'static str) {
        match self.left_out.iter_mut().find(|it| it.why == why) {
            Some(before) => before.rows += rows,
            None if rows > 0 => self.left_out.push(LeftOut { rows, why }),
            None => {}
        }
    }

    /// The rows that are left out and why, for people; none where all are shown.
    #[must_use]
    pub fn left_out_words(&self) -> Option<String> {
        let words: Vec<String> = self.left_out.iter().map(ToString::to_string).collect();
        (!words.is_empty()).then(|| words.join(", "))
    }
}

/// The harness's width and height.
const SIZE: [u32; 2] = [512, 512];

/// The harness's words for emission and absorption.
const MODES: [&str; 2] = ["composite", "translucent"];

/// The harness's volumes, and the analytic fields that they are.
const VOLUMES: [(&str, &str); 2] = [("ml", "marschner_lobb"), ("c60", "c60")];

/// The transfer function of the harness, by the name of its file.
const TRANSFER: &str = "comparison.ron";

/// The harness's name of a graph's volume, where the graph is the harness's scene: its field, its 128³ bytes, and its
/// transfer function.
#[must_use]
pub fn harness_volume(graph: &GraphDesc) -> Option<&'static str> {
    let field = |name: &str, source: &volgraph_graph::SourceDesc| {
        source.params.get(name).map(|param| param.value.clone())
    };
    let text = |text: &str| Some(ParamValue::Text(text.to_owned()));
    let sources = || graph.sources.values();
    let has_transfer = sources().any(|source| {
        source.kind == "transfer"
            && matches!(field("path", source), Some(ParamValue::Text(path))
                if path.rsplit('/').next() == Some(TRANSFER))
    });
    let volume = sources().find(|source| source.kind == "analytic")?;
    let is_bytes = field("type", volume) == text("uint8")
        && field("dims", volume) == Some(ParamValue::Vector(vec![128.0; 3]));
    let names = VOLUMES.iter().filter(|_| has_transfer && is_bytes);
    names
        .into_iter()
        .find(|(_, name)| field("field", volume) == text(name))
        .map(|(harness, _)| *harness)
}
