//! What was measured so far, as a file and as a page.

use std::path::{Path, PathBuf};

use serde::Serialize;
use volgraph::bench::{Growth, PeerPoint, PeerRow, Table};
use volgraph::{AdapterSummary, Finding, Findings};

use super::page;
use super::start_up::StartUp;
use crate::commands::write;
use crate::output;

/// All that a report holds.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The version of volgraph.
    pub volgraph: &'static str,
    /// What it was measured on.
    pub adapter: AdapterSummary,
    /// Whether all of it was measured; else it was interrupted, or is not done.
    pub is_complete: bool,
    /// Volumes of the tables.
    pub volumes: Vec<Volume>,
    /// Techniques of the tables and curves.
    pub techniques: Vec<Named>,
    /// Step of the tables in voxels.
    pub step_voxels: f64,
    /// Views of the rotation.
    pub views: usize,
    /// Degrees between neighbours of them.
    pub turn_degrees: f64,
    /// A technique on a volume at a size each.
    pub tables: Vec<Table>,
    /// A technique along an axis each.
    pub growth: Vec<Growth>,
    /// Other renderers beside volgraph.
    pub peers: Vec<PeerRow>,
    /// volgraph's methods beside them, for the chart.
    pub points: Vec<PeerPoint>,
    /// Starts of the program.
    pub start_up: Vec<StartUp>,
}

/// A volume.
#[derive(Debug, Serialize)]
pub struct Volume {
    pub name: String,
    pub dims: [u32; 3],
    pub summary: String,
}

/// A technique's name and what it is.
#[derive(Debug, PartialEq, Serialize)]
pub struct Named {
    pub name: String,
    pub doc: String,
}

impl Report {
    /// Nothing measured.
    pub fn new(adapter: AdapterSummary) -> Self {
        Self {
            volgraph: env!("CARGO_PKG_VERSION"),
            adapter,
            is_complete: false,
            volumes: Vec::new(),
            techniques: Vec::new(),
            step_voxels: 1.0,
            views: 0,
            turn_degrees: 0.0,
            tables: Vec::new(),
            growth: Vec::new(),
            peers: Vec::new(),
            points: Vec::new(),
            start_up: Vec::new(),
        }
    }

    /// Notes what a technique is, once.
    pub fn name(&mut self, name: &str, doc: &str) {
        let named = Named {
            name: name.to_owned(),
            doc: doc.to_owned(),
        };
        if !self.techniques.contains(&named) {
            self.techniques.push(named);
        }
    }
}

/// A report and its folder.
pub struct Writer {
    folder: PathBuf,
    pub report: Report,
}

impl Writer {
    /// Makes the folder.
    pub fn new(folder: &Path, report: Report) -> Result<Self, Findings> {
        write::folder(folder)?;
        let writer = Self {
            folder: folder.to_path_buf(),
            report,
        };
        // What cannot be written is told before anything is measured.
        writer.write()?;
        Ok(writer)
    }

    /// Writes what there is.
    pub fn write(&self) -> Result<(), Findings> {
        let json = serde_json::to_string_pretty(&self.report).map_err(|error| {
            Finding::error("io", format!("the report cannot be written: {error}"))
        })?;
        write::whole(&self.folder.join("bench.json"), json)?;
        write::whole(&self.folder.join("index.html"), page::of(&self.report)?)
    }

    /// Writes all of it and says where.
    pub fn finish(mut self, is_json: bool) -> Result<(), Findings> {
        self.report.is_complete = true;
        self.write()?;
        if is_json {
            output::print_json(&serde_json::to_value(&self.report).unwrap_or_default());
        } else {
            output::print(&format!("{}", self.folder.join("index.html").display()));
        }
        Ok(())
    }
}
