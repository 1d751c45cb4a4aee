//! What was found of a graph, and how it is told.

use std::path::Path;

use serde_json::{Value, json};
use volgraph::Findings;
use volgraph::methods::peers::{Peer, ScenePeers};
use volgraph::methods::{Measurement, MethodSpace, Survey, TruthKind, front};

use super::pictures::AllFiles;
use super::{plot, table};
use crate::commands::write;

/// What a chart shows of a graph.
pub struct Exhibit {
    /// Its files' name.
    pub name: String,
    /// What the graph draws, one sentence.
    pub draws: String,
    /// The graph's text.
    pub graph: String,
    /// Width and height of the pictures.
    pub size: [u32; 2],
    /// What drew them.
    pub adapter: String,
    /// `--methods`, as it was typed.
    pub filters: String,
    /// What was set on the command line.
    pub set: Vec<String>,
    /// Other renderers of the same scene, and the table's rows that are not.
    pub others: ScenePeers,
    /// Where the truth comes from.
    pub truth: TruthKind,
    /// Bound of its own error.
    pub truth_bound: Option<f64>,
    /// The step in voxels of a truth that is drawn finely.
    pub fine_step: f64,
    /// Seconds that the truth took, which the survey's time does not have.
    pub truth_seconds: f64,
    /// How many pixels are core pixels.
    pub core_pixels: usize,
    /// The pictures.
    pub pictures: AllFiles,
    /// The measurements.
    pub survey: Survey,
    /// All methods.
    pub space: MethodSpace,
}

/// Which error is drawn upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// Of all pixels and components, 1 is white.
    Rmse,
    /// Of red, green and blue of core pixels in 8-bit steps, as other renderers' harness has it.
    CoreSteps,
}

impl Metric {
    /// The error of a measurement.
    pub fn of(self, measured: &Measurement) -> f64 {
        match self {
            Self::Rmse => measured.errors.rmse,
            Self::CoreSteps => measured.errors.core_rmse * 255.0,
        }
    }

    /// The same of the picture rounded to 8 bits.
    pub fn of_rounded(self, measured: &Measurement) -> f64 {
        match self {
            Self::Rmse => measured.errors.rmse_8bit,
            Self::CoreSteps => measured.errors.core_rmse_8bit * 255.0,
        }
    }
}

/// A value as people read it: numbers with at most two digits that are not 0 behind the first.
pub fn short(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) if value.len() > 6 => format!("{number:.2e}"),
        _ => value.strip_suffix(".0").unwrap_or(value).to_owned(),
    }
}

/// A peer, and the fastest method that is faster and more accurate, with its picture rounded to 8 bits like the peer's.
pub struct Beaten<'e> {
    pub peer: &'e Peer,
    pub by: Option<&'e Measurement>,
}

impl Exhibit {
    /// The error of the chart: peers' where there are some.
    pub fn metric(&self) -> Metric {
        if self.others.peers.is_empty() {
            Metric::Rmse
        } else {
            Metric::CoreSteps
        }
    }

    /// Indices of the measurements on the front of the chart's error, by rising time.
    pub fn front(&self) -> Vec<usize> {
        let metric = self.metric();
        let measured = self.survey.measured.iter();
        let points: Vec<(f64, f64)> = measured.map(|it| (it.steady_ms, metric.of(it))).collect();
        front(&points)
    }

    /// The names of the axes, each once: renderers may have settings of one name.
    pub fn columns(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for axis in &self.space.axes {
            if !names.contains(&axis.name.as_str()) {
                names.push(&axis.name);
            }
        }
        names
    }

    /// Whether any axis of a name has more than one value.
    fn is_varied(&self, name: &str) -> bool {
        let mut axes = self.space.axes.iter().filter(|axis| axis.name == name);
        axes.any(|axis| axis.values.len() > 1)
    }

    /// The axes that have more than one value.
    pub fn varied(&self) -> Vec<&str> {
        let mut names = self.columns();
        names.retain(|name| self.is_varied(name));
        names
    }

    /// The settings that all methods share.
    pub fn shared(&self) -> Vec<String> {
        let axes = self.space.axes.iter();
        let axes = axes.filter(|axis| !axis.is_software && !self.is_varied(&axis.name));
        axes.map(|axis| format!("{}={}", axis.name, axis.values[0]))
            .collect()
    }

    /// A method by its values on the axes that are given.
    pub fn label(&self, measured: &Measurement, axes: &[&str]) -> String {
        let values = axes.iter().map(|axis| short(&measured.method.text(axis)));
        // Not every renderer has all settings.
        let values: Vec<String> = values.filter(|value| !value.is_empty()).collect();
        values.join(" · ")
    }

    /// The peers against the methods.
    pub fn beaten(&self) -> Vec<Beaten<'_>> {
        let metric = self.metric();
        let beats = |measured: &&Measurement, peer: &Peer| {
            measured.steady_ms < peer.median_ms
                && metric.of_rounded(measured) < peer.core_rmse_8bit_steps
        };
        let peers = self.others.peers.iter();
        peers
            .map(|peer| Beaten {
                peer,
                by: self
                    .survey
                    .measured
                    .iter()
                    .filter(|measured| beats(measured, peer))
                    .min_by(|a, b| a.steady_ms.total_cmp(&b.steady_ms)),
            })
            .collect()
    }

    /// Writes the table and the chart.
    pub fn write(&self, folder: &Path) -> Result<(), Findings> {
        write::whole(
            &folder.join(format!("{}.csv", self.name)),
            &table::csv(self)?,
        )?;
        let plot = plot::draw(self)?;
        write::whole(&folder.join(format!("{}.svg", self.name)), &plot.svg)
    }

    /// The front, for people.
    pub fn to_text(&self) -> String {
        let mut lines = vec![format!(
            "{}: {} of {} methods measured in {:.0} s, after {:.0} s for the truth; {} refused; the front:",
            self.name,
            self.survey.measured.len(),
            self.survey.product,
            self.survey.seconds,
            self.truth_seconds,
            self.survey.refused.len()
        )];
        let varied = self.varied();
        for at in self.front() {
            let measured = &self.survey.measured[at];
            lines.push(format!(
                "  {:8.1} ms  rmse {:.2e}  max {:.2e}  {}",
                measured.steady_ms,
                measured.errors.rmse,
                measured.errors.max,
                self.label(measured, &varied)
            ));
        }
        for (method, why) in &self.survey.refused {
            lines.push(format!("  refused: {method}: {why}"));
        }
        if let Some(left_out) = self.others.left_out_words() {
            lines.push(format!("  other renderers, not shown: {left_out}"));
        }
        lines.join("\n")
    }

    /// Everything, for programs.
    pub fn to_json(&self) -> Value {
        json!({
            "name": self.name, "survey": self.survey,
            "peers": self.others.peers, "peers_left_out": self.others.left_out, "truth_seconds": self.truth_seconds,
            "truth": match self.truth { TruthKind::Reference => "reference", TruthKind::Fine => "fine" },
            "truth_bound": self.truth_bound,
        })
    }
}
