//! Transfer functions that are named: for CT in Hounsfield units, for MR and others by what the volume holds.
//!
//! The way of the data: a [`Preset`] is a list of control points. [`Preset::text`] lays them over the values of a volume:
//! those in Hounsfield units by the offset that the volume is stored with ([`hounsfield_offset`]), the others from the
//! value that parts background from what is drawn (Otsu, "A threshold selection method from gray-level histograms", 1979)
//! to one that few voxels exceed. Opacities hold for a 256th of the volume's size, so that a finer grid of the same thing
//! looks the same.

use std::fmt::Write;

use volgraph_nodes::placement;
use volgraph_optics::{Domain, TransferFunction};
use volgraph_report::{Finding, did_you_mean};
use volgraph_volume::{Histogram, Volume};

/// What a preset's positions count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Hounsfield units: air is at -1000, water at 0.
    Hounsfield,
    /// 0 is the value that parts background from the rest, 1 the one that 0.2 percent of all voxels exceed.
    Foreground,
}

/// A named transfer function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Its name, such as `ct-bone`.
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// What its positions count.
    pub scale: Scale,
    /// Position, sRGB colour, opacity of a 256th of the volume's size; rising.
    pub points: &'static [(f64, &'static str, f64)],
}

const PRESETS: [Preset; 8] = [
    Preset {
        name: "ct-bone",
        shows: "CT: bone, and a breath of skin",
        scale: Scale::Hounsfield,
        points: &[
            (-1000.0, "#d8a080", 0.0),
            (-500.0, "#d8a080", 0.0),
            (-250.0, "#e0a888", 0.02),
            (-50.0, "#c88068", 0.004),
            (120.0, "#b06850", 0.004),
            (250.0, "#dcb890", 0.15),
            (500.0, "#f0e4cc", 0.6),
            (1500.0, "#fff8ec", 0.9),
        ],
    },
    Preset {
        name: "ct-soft-tissue",
        shows: "CT: fat, muscle and organs before bone",
        scale: Scale::Hounsfield,
        points: &[
            (-1000.0, "#d8a070", 0.0),
            (-180.0, "#d8a070", 0.0),
            (-100.0, "#e0b080", 0.02),
            (-30.0, "#c87860", 0.06),
            (50.0, "#b05848", 0.2),
            (140.0, "#d08060", 0.3),
            (300.0, "#f0dcc0", 0.6),
            (1500.0, "#fff8ec", 0.9),
        ],
    },
    Preset {
        name: "ct-lung",
        shows: "CT: lungs, their vessels and airways",
        scale: Scale::Hounsfield,
        points: &[
            (-1000.0, "#6890b0", 0.0),
            (-950.0, "#6890b0", 0.0),
            (-850.0, "#88a8c8", 0.02),
            (-700.0, "#a8b0c0", 0.05),
            (-550.0, "#d09080", 0.15),
            (-400.0, "#d07060", 0.1),
            (-250.0, "#c07060", 0.0),
            (250.0, "#f0e4cc", 0.0),
            (600.0, "#f0e4cc", 0.05),
        ],
    },
    Preset {
        name: "ct-angio",
        shows: "CT: vessels with contrast medium, and bone",
        scale: Scale::Hounsfield,
        points: &[
            (-1000.0, "#a02018", 0.0),
            (120.0, "#a02018", 0.0),
            (180.0, "#c83828", 0.25),
            (320.0, "#e86048", 0.6),
            (480.0, "#f0d8b8", 0.7),
            (1500.0, "#fff8ec", 0.9),
        ],
    },
    Preset {
        name: "ct-skin",
        shows: "CT: the skin, opaque",
        scale: Scale::Hounsfield,
        points: &[
            (-1000.0, "#d8a080", 0.0),
            (-600.0, "#d8a080", 0.0),
            (-300.0, "#e4b090", 0.5),
            (0.0, "#d89878", 0.8),
            (400.0, "#f0e4cc", 0.9),
        ],
    },
    Preset {
        name: "mr-t1",
        shows: "MR, T1: a head or brain, brighter tissue lighter",
        scale: Scale::Foreground,
        points: &[
            (-0.1, "#806058", 0.0),
            (0.05, "#98746a", 0.02),
            (0.3, "#c09080", 0.25),
            (0.6, "#e4c8b4", 0.5),
            (1.0, "#fff8f0", 0.8),
        ],
    },
    Preset {
        name: "mr-angio",
        shows: "angiography: vessels, the brightest that there is",
        scale: Scale::Foreground,
        points: &[
            (0.2, "#802018", 0.0),
            (0.4, "#c03828", 0.25),
            (0.7, "#e87858", 0.7),
            (1.0, "#fff0d8", 0.9),
        ],
    },
    Preset {
        name: "solid",
        shows: "anything: what is above the background, from warm to light",
        scale: Scale::Foreground,
        points: &[
            (-0.05, "#a06850", 0.0),
            (0.15, "#c08060", 0.15),
            (0.5, "#e0bc90", 0.5),
            (1.0, "#fff8ec", 0.9),
        ],
    },
];

/// All of them.
#[must_use]
pub fn presets() -> &'static [Preset] {
    &PRESETS
}

/// The preset of a name.
///
/// # Errors
/// `unknown-preset`.
pub fn preset(name: &str) -> Result<&'static Preset, Finding> {
    let found = PRESETS.iter().find(|preset| preset.name == name);
    found.ok_or_else(|| {
        Finding::error("unknown-preset", format!("no preset is named `{name}`"))
            .help_opt(did_you_mean(name, PRESETS.iter().map(|preset| preset.name)))
    })
}

impl Preset {
    /// The transfer function for a volume, as the text of a file; `title` is its first line.
    ///
    /// # Errors
    /// `not-hounsfield` for a preset in Hounsfield units and a volume that is not.
    pub fn text(&self, volume: &Volume) -> Result<String, Finding> {
        let (from, per_unit) = match self.scale {
            Scale::Hounsfield => {
                let offset = hounsfield_offset(volume).ok_or_else(|| {
                    let message = format!(
                        "`{}` counts Hounsfield units, and this volume has no air near -1000 with tissue around 0",
                        self.name
                    );
                    Finding::error("not-hounsfield", message)
                        .help("take a preset that counts what the volume holds: `solid`, `mr-t1` or `mr-angio`")
                })?;
                (offset, 1.0)
            }
            Scale::Foreground => {
                let (low, high) = foreground(volume);
                (low, high - low)
            }
        };
        let place = |at: f64| from + at * per_unit;
        let points: Vec<_> = self
            .points
            .iter()
            .map(|(at, color, opacity)| (place(*at), *color, *opacity))
            .collect();
        Ok(points_text(&format!("{}.", self.shows), volume, &points))
    }
}

/// The text of a file with control points at data values, whose opacities hold for a 256th of the volume's size.
pub(crate) fn points_text(title: &str, volume: &Volume, points: &[(f64, &str, f64)]) -> String {
    let mut text = format!(
        "// {title}\n(\n    domain: data,\n    {},\n    points: [\n",
        reference_length(volume)
    );
    for (at, color, opacity) in points {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "        (at: {at:?}, color: {color:?}, opacity: {opacity:?}),"
        );
    }
    text.push_str("    ],\n)\n");
    text
}

/// The field `reference_length` for opacities of a 256th of a volume's size.
pub(crate) fn reference_length(volume: &Volume) -> String {
    let grid = volume.grid();
    let size = (0..3).map(|axis| grid.spacing()[axis] * f64::from(grid.dims[axis]));
    let length = size.fold(0.0, f64::max) / 256.0;
    format!("reference_length: (world: {:?})", length.clamp(1e-30, 1e30))
}

/// The share of voxels in `low..=high`.
fn share(volume: &Volume, low: f64, high: f64) -> f64 {
    let count = Histogram::of(volume.voxels(), low, high, 1).counts[0];
    count as f64 / volume.statistics().finite_count.max(1) as f64
}

/// What is added to Hounsfield units where a volume is stored: 0, or 1024 or 1000 for unsigned values. `None` where it is no
/// CT in such units: those have air, or what is filled in for it, and tissue as dense as water, and few values beyond metal.
#[must_use]
pub fn hounsfield_offset(volume: &Volume) -> Option<f64> {
    let (min, max) = volume.statistics().range()?;
    [0.0, 1024.0, 1000.0].into_iter().find(|offset| {
        let (min, max) = (min - offset, max - offset);
        let has_values = (-4096.0..=-850.0).contains(&min) && (150.0..=33_000.0).contains(&max);
        let air = share(volume, min + offset, offset - 800.0);
        let tissue = share(volume, offset - 200.0, offset + 200.0);
        let dense = share(volume, offset + 4000.0, offset + max);
        has_values && air > 0.02 && tissue > 0.02 && dense < 0.05
    })
}

/// The value that parts background from the rest, and the one that 0.2 percent of all voxels exceed: `low < high`.
#[must_use]
pub fn foreground(volume: &Volume) -> (f64, f64) {
    let statistics = volume.statistics();
    let Some((min, max)) = statistics.range() else {
        return (0.0, 1.0);
    };
    let mut high = statistics.percentile(99.8);
    if high <= min {
        high = max;
    }
    let low = otsu(&Histogram::of(volume.voxels(), min, high, 256));
    let least = (1e-4 * low.abs().max(high.abs())).max(1e-29);
    (low, high.max(low + least))
}

/// The threshold with the largest variance between what is below and above it.
fn otsu(histogram: &Histogram) -> f64 {
    let total: f64 = histogram.counts.iter().map(|&count| count as f64).sum();
    let weighted = |(bin, &count): (usize, &u64)| bin as f64 * count as f64;
    let sum: f64 = histogram.counts.iter().enumerate().map(weighted).sum();
    let (mut below, mut below_sum, mut best) = (0.0, 0.0, (0.0, 0));
    for (bin, &count) in histogram.counts.iter().enumerate() {
        below += count as f64;
        below_sum += bin as f64 * count as f64;
        let above = total - below;
        if below > 0.0 && above > 0.0 {
            let apart = below_sum / below - (sum - below_sum) / above;
            let between = below * above * apart * apart;
            if between > best.0 {
                best = (between, bin + 1);
            }
        }
    }
    let t = best.1 as f64 / histogram.counts.len().max(1) as f64;
    histogram.lo * (1.0 - t) + histogram.hi * t
}

/// Extinction per reference length from which a voxel counts as seen.
pub const VISIBLE_EXTINCTION: f64 = 1e-3;

/// An estimate of the share of a volume's voxels whose extinction is above [`VISIBLE_EXTINCTION`], from a histogram of it:
/// as if its values lay evenly in each bin.
#[must_use]
pub fn visible_share(volume: &Volume, histogram: &Histogram, transfer: &TransferFunction) -> f64 {
    const SAMPLES: u32 = 16;
    let (from, to) = match transfer.domain() {
        Domain::Data => (0.0, 1.0),
        Domain::Normalised => placement::normalised_range(volume),
        Domain::Range => placement::data_range(volume),
    };
    let bins = histogram.counts.len() as f64;
    let is_seen = |bin: usize, sample: u32| {
        let t = (bin as f64 + (f64::from(sample) + 0.5) / f64::from(SAMPLES)) / bins;
        let value = histogram.lo * (1.0 - t) + histogram.hi * t;
        transfer.extinction((value - from) / (to - from)) > VISIBLE_EXTINCTION
    };
    let (mut seen, mut all) = (0.0, 0.0);
    for (bin, &count) in histogram
        .counts
        .iter()
        .enumerate()
        .filter(|(_, count)| **count > 0)
    {
        let samples = (0..SAMPLES).filter(|sample| is_seen(bin, *sample)).count();
        seen += count as f64 * samples as f64 / f64::from(SAMPLES);
        all += count as f64;
    }
    if all > 0.0 { seen / all } else { 0.0 }
}

/// The comments that a text begins with, to be kept where all else of it is written anew.
#[must_use]
pub fn leading_comments(text: &str) -> &str {
    let mut end = 0;
    for line in text.split_inclusive('\n') {
        let line_text = line.trim();
        if !(line_text.is_empty() || line_text.starts_with("//")) {
            break;
        }
        end += line.len();
    }
    &text[..end]
}

#[cfg(test)]
mod tests;
