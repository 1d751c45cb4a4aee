//! What the pages of a file are: slices, channels and time steps, by ImageJ's description or by OME-XML.
//!
//! ImageJ writes `key=value` lines; its pages are in the order channel, slice, time, the fastest first. OME-XML says
//! the order itself, and may say for each page what it is. Both may give lengths and times with their units.

use glam::DVec3;
use volgraph_volume::{Trouble, VolumeError};

use super::pages::Pages;
use crate::load::LoadOptions;

mod ome;

/// What the pages are.
pub(super) struct Layout {
    pub format: String,
    pub channels: usize,
    pub slices: usize,
    pub steps: usize,
    /// Pages in the order of time (slowest), slice and channel (fastest).
    pub order: Vec<usize>,
    pub spacing: DVec3,
    pub length_unit: Option<String>,
    /// Time from a step to the next.
    pub interval: Option<f64>,
    pub time_unit: Option<String>,
    pub facts: Vec<(String, String)>,
    pub warnings: Vec<String>,
}

pub(super) fn of(pages: &mut Pages<'_>, options: &LoadOptions) -> Result<Layout, VolumeError> {
    match pages.description.clone() {
        Some(text) if text.starts_with("ImageJ=") => imagej(pages, &text),
        Some(text) if text.trim_start().starts_with('<') && text.contains("<OME") => {
            ome::layout(pages, text.trim_start().trim_end_matches('\0'), options)
        }
        _ => Ok(plain(pages)),
    }
}

impl Layout {
    /// A file per slice: the layout of the first file, with more slices.
    pub fn stack_files(&mut self, files: usize) {
        (self.channels, self.slices, self.steps) = (1, files, 1);
        self.order = (0..files).collect();
    }

    /// A file per time step.
    pub fn steps_in_files(&mut self, files: usize, pages: usize) -> Result<(), VolumeError> {
        if self.steps > 1 {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!(
                    "each of {files} files has {} time steps of its own",
                    self.steps
                ),
                "give one of the files",
            )));
        }
        let one = std::mem::take(&mut self.order);
        let all = (0..files).flat_map(|file| one.iter().map(move |page| file * pages + page));
        self.order = all.collect();
        self.steps = files;
        Ok(())
    }
}

/// Pages as slices.
fn plain(pages: &Pages<'_>) -> Layout {
    let (columns, rows, length_unit) = plain_spacing(pages);
    Layout {
        format: "TIFF".into(),
        channels: 1,
        slices: pages.count(),
        steps: 1,
        order: (0..pages.count()).collect(),
        spacing: DVec3::new(columns, rows, columns),
        length_unit,
        interval: None,
        time_unit: None,
        facts: Vec::new(),
        warnings: Vec::new(),
    }
}

/// Steps along x and y by the resolution, and their unit. A resolution without a unit tells only how long a pixel is
/// against its width.
fn plain_spacing(pages: &Pages<'_>) -> (f64, f64, Option<String>) {
    let [Some(x), Some(y)] = pages.resolution else {
        return (1.0, 1.0, None);
    };
    match pages.resolution_unit {
        2 => (25.4 / x, 25.4 / y, Some("mm".into())),
        3 => (10.0 / x, 10.0 / y, Some("mm".into())),
        _ => (1.0, x / y, None),
    }
}

/// Units of length as people write them.
fn unit(text: &str) -> String {
    match text.trim() {
        "micron" | "microns" | "um" | "\\u00B5m" | "\u{3bc}m" => "µm".into(),
        other => other.to_owned(),
    }
}

fn imagej(pages: &mut Pages<'_>, text: &str) -> Result<Layout, VolumeError> {
    let value = |key: &str| {
        let mut lines = text.lines().filter_map(|line| line.split_once('='));
        lines
            .find(|(found, _)| found.trim() == key)
            .map(|(_, value)| value.trim())
    };
    let count = |key: &str| -> usize {
        value(key)
            .and_then(|value| value.parse().ok())
            .unwrap_or(1)
            .max(1)
    };
    let number = |key: &str| -> Option<f64> {
        let value = value(key)?.parse::<f64>().ok()?;
        Some(value.abs()).filter(|value| value.is_finite() && *value > 0.0)
    };
    let images = count("images");
    if images > pages.count() && !pages.lie_behind_the_first(images)? {
        return Err(VolumeError::DataTooShort(Trouble::new(
            format!(
                "ImageJ's description says {images} images, the file has {}",
                pages.count()
            ),
            "the file is cut off: fetch it again, or save it anew",
        )));
    }
    let mut layout = plain(pages);
    layout.format = format!("TIFF of ImageJ {}", value("ImageJ").unwrap_or_default());
    let (channels, slices, steps) = (count("channels"), count("slices"), count("frames"));
    let product = channels
        .checked_mul(slices)
        .and_then(|product| product.checked_mul(steps));
    if product == Some(pages.count()) {
        (layout.channels, layout.slices, layout.steps) = (channels, slices, steps);
    } else if pages.count() > 1 {
        layout.warnings.push(format!(
            "ImageJ's description says {channels} channels, {slices} slices and {steps} frames, the file has {} \
             pages: they are taken as slices",
            pages.count()
        ));
    }
    let named = value("unit").filter(|unit| !unit.is_empty() && *unit != "pixel");
    if let Some(named) = named {
        layout.length_unit = Some(unit(named));
        let [x, y] = pages
            .resolution
            .map(|pixels| pixels.map_or(1.0, |pixels| 1.0 / pixels));
        layout.spacing = DVec3::new(x, y, x);
    }
    if let Some(spacing) = number("spacing") {
        layout.spacing.z = spacing;
    } else if layout.slices > 1 && named.is_some() {
        layout.warnings.push(
            "no spacing of the slices is said: they are taken to be as far apart as the columns"
                .into(),
        );
    }
    layout.interval = number("finterval").or_else(|| number("fps").map(|fps| 1.0 / fps));
    layout.time_unit = layout
        .interval
        .map(|_| value("tunit").map_or("s".to_owned(), unit));
    if let Some(title) = value("Info").or_else(|| value("Title")) {
        layout
            .facts
            .push(("title".into(), title.chars().take(200).collect()));
    }
    Ok(layout)
}
