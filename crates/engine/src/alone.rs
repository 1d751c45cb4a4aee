//! A volume file alone: the graph and the transfer function that fit what is in it.
//!
//! The way of the data: [`is_volume`] tells a volume from a graph by its content. [`graph_for`] reads the volume, looks at
//! its values, and writes a graph with all in it: [`Alone::graph`] is what is drawn, at the path that [`path_for`] gives,
//! and [`Alone::files`] the same as files to keep. The choice follows the values alone: few whole numbers in patches are
//! labels, however far apart they are; two values a mask; air near -1000 with water near 0 is CT; else the values above
//! the background are drawn.

mod looks;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use volgraph_formats::bricks::{BrickStore, StoreOptions, pyramid_path};
use volgraph_formats::{LoadOptions, parse_raw_name};
use volgraph_nodes::source::bricks::overview;
use volgraph_report::{Finding, Findings};
use volgraph_volume::{Component, Values, Volume, VolumeError};

use self::looks::{Looks, looks};
use crate::presets::{foreground, hounsfield_offset, points_text, preset, reference_length};

/// What the paths of such graphs begin with.
const ROOT: &str = "embedded:/alone/";

/// A graph for a volume.
#[derive(Clone, Debug, PartialEq)]
pub struct Alone {
    /// The graph's text, with the transfer function in it.
    pub graph: String,
    /// The transfer function's text; none where the graph draws without.
    pub transfer: Option<String>,
    /// What was picked, and why.
    pub why: String,
}

/// Whether a file, a folder or a pattern of names is a volume rather than a graph.
#[must_use]
pub fn is_volume(path: &Path) -> bool {
    let is_ron = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("ron"));
    if is_ron {
        return false;
    }
    if !path.is_file() {
        // A folder of slices, or a pattern that names them.
        return volgraph_formats::is_volume(path);
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if parse_raw_name(&name).is_ok() {
        return true;
    }
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(1024).read_to_end(&mut head));
    let is_picture = head.starts_with(b"\x89PNG") || head.starts_with(b"\x76\x2f\x31\x01");
    let text = String::from_utf8_lossy(&head);
    let is_header = ["NRRD", "<?xml", "<VTKFile", "# vtk"]
        .iter()
        .any(|it| text.starts_with(it))
        || text.contains("ObjectType")
        || text.contains("NDims");
    read.is_ok() && !is_picture && (is_header || head.contains(&0))
}

/// The path that stands for the graph of a volume.
#[must_use]
pub fn path_for(volume: &Path) -> PathBuf {
    let volume = std::path::absolute(volume).unwrap_or_else(|_| volume.to_path_buf());
    format!("{ROOT}{}", volume.display()).into()
}

/// The volume that a path stands for the graph of.
#[must_use]
pub fn volume_of(path: &Path) -> Option<PathBuf> {
    path.to_str()?.strip_prefix(ROOT).map(PathBuf::from)
}

/// The graph for a volume file. What was picked last is remembered until the file changes.
///
/// # Errors
/// What is wrong with the file.
pub fn graph_for(path: &Path) -> Result<Alone, Findings> {
    type Last = Option<(PathBuf, u64, Option<SystemTime>, Alone)>;
    static LAST: Mutex<Last> = Mutex::new(None);
    let metadata = path.metadata().ok();
    let length = metadata.as_ref().map_or(0, std::fs::Metadata::len);
    let modified = metadata.and_then(|it| it.modified().ok());
    let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((file, was_length, was_modified, alone)) = &*last()
        && (file.as_path(), *was_length, *was_modified) == (path, length, modified)
    {
        return Ok(alone.clone());
    }
    if let Some(alone) = in_bricks(path)? {
        *last() = Some((path.to_path_buf(), length, modified, alone.clone()));
        return Ok(alone);
    }
    let (volume, field) = load(path).map_err(|error| Findings::from(Finding::from(error)))?;
    let mut alone = pick(&volume, &path.display().to_string());
    if !field.is_empty() {
        let file = format!("volume(path: {}", quoted(&path.display().to_string()));
        alone.graph = alone.graph.replacen(&file, &format!("{file}, {field}"), 1);
    }
    *last() = Some((path.to_path_buf(), length, modified, alone.clone()));
    Ok(alone)
}

/// Voxels that take more bytes are drawn in bricks where there is a pyramid.
const WHOLE_BYTES: u64 = 512 << 20;

/// The graph for a volume that is too large to be read whole and has its pyramid beside it.
fn in_bricks(path: &Path) -> Result<Option<Alone>, Findings> {
    let of_volume = |error: VolumeError| Findings::from(Finding::from(error));
    if !pyramid_path(path).exists() {
        return Ok(None);
    }
    // A pyramid of another state or choice of the file is no reason not to draw the file itself.
    let Ok(store) = BrickStore::open(path, &StoreOptions::default()) else {
        return Ok(None);
    };
    let voxels = |dims: [u32; 3]| {
        dims.map(u64::from)
            .iter()
            .fold(1, |n: u64, d| n.saturating_mul(*d))
    };
    let levels = store.levels();
    let bytes = voxels(levels[0].grid.dims).saturating_mul(store.scalar_type().size() as u64);
    // Means of labels are no labels.
    if bytes <= WHOLE_BYTES || matches!(store.about().values, Values::Labels(_)) {
        return Ok(None);
    }
    let volume = overview(&store).map_err(of_volume)?;
    let mut alone = pick(&volume, &path.display().to_string());
    alone.graph = alone
        .graph
        .replacen("volume(path: ", "bricks(path: ", 1)
        .replace(
            r#""gradient_method": "sobel""#,
            r#""gradient": "central", "traverse": "skip""#,
        )
        .replace(r#""step": 0.5"#, r#""step": 1.0"#);
    if !alone.graph.contains(r#""gradient": "#) {
        // Stored gradients are of whole volumes.
        alone.graph = alone
            .graph
            .replacen("slots: { ", r#"slots: { "gradient": "central", "#, 1);
    }
    let why = format!(
        "{}; larger than {} MiB, and so in bricks",
        alone.why,
        WHOLE_BYTES >> 20
    );
    alone.graph = alone.graph.replacen(&alone.why, &why, 1);
    alone.why = why;
    Ok(Some(alone))
}

/// The volume, and the field that takes one value where there are several and none is a choice of the file's own: their
/// length.
fn load(path: &Path) -> Result<(Volume, &'static str), VolumeError> {
    let plain = volgraph_formats::load(path, &LoadOptions::default());
    let Err(VolumeError::Component(_)) = plain else {
        return plain.map(|volume| (volume, ""));
    };
    let options = LoadOptions {
        component: Some(Component::Magnitude),
        ..LoadOptions::default()
    };
    volgraph_formats::load(path, &options).map(|volume| (volume, "component: \"magnitude\""))
}

impl Alone {
    /// The same as files: the graph, and beside it its transfer function under the name given.
    #[must_use]
    pub fn files(&self, transfer_name: &str) -> (String, Option<String>) {
        let Some(transfer) = &self.transfer else {
            return (self.graph.clone(), None);
        };
        let inline = format!("transfer(text: {})", quoted(transfer));
        let named = format!("transfer(path: {})", quoted(transfer_name));
        (self.graph.replace(&inline, &named), Some(transfer.clone()))
    }
}

fn quoted(text: &str) -> String {
    ron::to_string(text).unwrap_or_else(|_| format!("{text:?}"))
}

fn pick(volume: &Volume, path: &str) -> Alone {
    let looks = looks(volume);
    let (min, max) = volume.statistics().range().unwrap_or((0.0, 1.0));
    if looks.distinct <= 2 {
        let why =
            format!("it has the values {min} and {max} alone: the surface between them, smooth");
        let slots = r#""technique": "isosurface", "light": "phong", "reconstruct": "tricubic", "gradient": "tricubic""#;
        let level = if max > min {
            min + 0.5 * (max - min)
        } else {
            min
        };
        let params = format!(
            r#""step": 0.5, "isovalue": {level:?}, "isovalue_unit": "data", "ambient": 0.25"#
        );
        return alone(path, None, slots, &params, why);
    }
    let lit = r#""classify": "preintegrated_2d", "light": "phong", "gradient_method": "sobel""#;
    let params = r#""step": 0.5, "ambient": 0.25, "diffuse": 0.8"#;
    if volume.colors().is_some() {
        let reference = reference_length(volume);
        let text = format!(
            "// Opacity alone: colours are the volume's own.\n(\n    domain: range,\n    {reference},\n    color: (1, 1, 1),\n    \
             opacity: [(0.0, 0.0), (0.1, 0.0), (0.6, 0.6), (1.0, 0.9)],\n)\n"
        );
        let why = "its voxels have colours of their own: they are drawn, the brighter the denser"
            .to_owned();
        let slots = format!("\"colors\": \"volume\", {lit}");
        return alone(path, Some(text), &slots, params, why);
    }
    if min.abs().max(max.abs()) > 1e29 {
        // Control points reach 1e30; these count 0 to 1 over the values that there are.
        let reference = reference_length(volume);
        let text = format!(
            "// All values, however large.\n(\n    domain: range,\n    {reference},\n    color: map(name: \"inferno\"),\n    \
             opacity: [(0.0, 0.0), (1.0, 0.5)],\n)\n"
        );
        let why = "its values go beyond 1e29: a ramp over all of them".to_owned();
        return alone(path, Some(text), lit, params, why);
    }
    let says_labels = matches!(volume.about().values, Values::Labels(_));
    if (says_labels || looks.are_labels()) && max - min >= 2.0 {
        let why = format!(
            "it has {} whole numbers in patches, {:.0} % of neighbours equal: labels, each its own colour",
            looks.distinct,
            100.0 * looks.equal
        );
        let why = if says_labels {
            format!(
                "its file says that its {} values are labels: each its own colour",
                looks.distinct
            )
        } else {
            why
        };
        return alone(
            path,
            Some(labels(min, &looks)),
            r#""reconstruct": "nearest", "classify": "post", "light": "phong""#,
            r#""step": 0.25"#,
            why,
        );
    }
    if let Some(offset) = hounsfield_offset(volume)
        && let Ok(text) = preset("ct-bone").and_then(|preset| preset.text(volume))
    {
        let stored = if offset == 0.0 {
            String::new()
        } else {
            format!(", stored {offset} higher")
        };
        let why = format!(
            "it has air near -1000 and tissue near 0: CT in Hounsfield units{stored}, the preset ct-bone"
        );
        return alone(path, Some(text), lit, params, why);
    }
    if !looks.is_whole {
        let (text, why) = field(volume);
        return alone(path, Some(text), lit, params, why);
    }
    let name = "solid";
    let text = preset(name)
        .and_then(|preset| preset.text(volume))
        .unwrap_or_default();
    let (low, high) = foreground(volume);
    let why = format!(
        "its values have no unit: what is above its background, from {low:.6} to {high:.6}, the preset {name}"
    );
    alone(path, Some(text), lit, params, why)
}

/// Labels: the smallest value is outside.
fn labels(min: f64, looks: &Looks) -> String {
    // Most labels of an atlas stand together, whatever a few have; beyond the last its colour holds, so that stray ones
    // take nothing from the others.
    let (from, to) = looks.most();
    let least = min + 0.5;
    format!(
        "// Labels: {min} is outside.\n(\n    domain: data(from: {min:?}, to: {to:?}),\n    color: map(name: \"turbo\", from: \
         {from:?}, to: {to:?}),\n    opacity: [({min:?}, 0.0), ({least:?}, 0.0), ({least:?}, 0.6), ({to:?}, 0.6)],\n)\n"
    )
}

fn volume_share_of_min(volume: &Volume) -> f64 {
    let min = volume.statistics().min;
    let count = volgraph_volume::Histogram::of(volume.voxels(), min, min, 1).counts[0];
    count as f64 / volume.statistics().finite_count.max(1) as f64
}

/// Numbers with fractions, as simulations have them: the upper quarter of the values, or both tails of values around 0.
fn field(volume: &Volume) -> (String, String) {
    let statistics = volume.statistics();
    let (min, max) = statistics.range().unwrap_or((0.0, 1.0));
    let (low, high) = (statistics.percentile(1.0), statistics.percentile(99.0));
    // A value that much of the grid has stands for what was not measured.
    let is_filled = volume_share_of_min(volume) > 0.2;
    let is_around_zero = !is_filled
        && low < 0.0
        && high > 0.0
        && (low + high).abs() < 0.5 * (high - low).max(f64::MIN_POSITIVE);
    let title = "The values that few voxels have.";
    if is_around_zero {
        let end = min.abs().max(max.abs()).max(1e-29);
        let [a, b] = [0.35, 0.7].map(|t| t * low.abs().max(high).min(end));
        let points = [
            (-end, "#2060c0", 0.8),
            (-b, "#4080d8", 0.35),
            (-a, "#90b8e8", 0.0),
            (a, "#e8b090", 0.0),
            (b, "#d86840", 0.35),
            (end, "#c03018", 0.8),
        ];
        let why = format!(
            "its values lie around 0, from {low:.6} to {high:.6}: both tails, blue below and red above"
        );
        return (points_text(title, volume, &points), why);
    }
    let (threshold, top) = foreground(volume);
    let start = threshold.max(statistics.percentile(75.0));
    let top = if top > start { top } else { max };
    let least = (1e-4 * start.abs().max(top.abs())).max(1e-29);
    let top = top.max(start + least);
    let at = |t: f64| start + t * (top - start);
    let text = format!(
        "// {title}\n(\n    domain: data,\n    {},\n    color: map(name: \"inferno\", from: {:?}, to: {top:?}),\n    opacity: [({:?}, 0.0), \
         ({:?}, 0.05), ({:?}, 0.3), ({top:?}, 0.7)],\n)\n",
        reference_length(volume),
        at(-0.4),
        at(0.0),
        at(0.15),
        at(0.5),
    );
    let why = format!(
        "it has numbers with fractions and no known unit: values from {start:.6}, in the colours of inferno"
    );
    (text, why)
}

fn alone(path: &str, transfer: Option<String>, slots: &str, params: &str, why: String) -> Alone {
    let source = transfer.as_ref().map_or_else(String::new, |text| {
        format!("        \"transfer\": transfer(text: {}),\n", quoted(text))
    });
    let input = if transfer.is_some() {
        r#""transfer": "transfer", "#
    } else {
        ""
    };
    let graph = format!(
        r#"// For this volume alone: {why}.
(
    sources: {{
        "volume": volume(path: {}),
{source}    }},
    camera: orbit(azimuth: 30, elevation: 15, zoom: 1.3),
    nodes: {{
        "background": (kind: "background",
                       params: {{ "pattern": "gradient", "bottom": [0.004, 0.006, 0.010, 1.0],
                                 "top": [0.035, 0.050, 0.075, 1.0] }}),
        "box":        (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image":      (kind: "raycast",
                       in: {{ "volume": "volume", {input}"rays": "box", "behind": "background" }},
                       slots: {{ {slots} }},
                       params: {{ {params} }}),
    }},
    outputs: {{ "color": "image.color" }},
)
"#,
        quoted(path)
    );
    Alone {
        graph,
        transfer,
        why,
    }
}

#[cfg(test)]
mod tests;
