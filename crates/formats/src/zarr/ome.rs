//! What OME-Zarr says of the arrays of a group: axes, levels, placement, channels, labels.
//!
//! Versions 0.1 to 0.5: `multiscales` in the attributes, or in their `ome`. Axes are objects, names alone, or (before
//! 0.3) t, c, z, y, x. Transformations of a level and those of all levels come one after the other.
//! Source: <https://ngff.openmicroscopy.org/0.5/>.

use std::collections::BTreeMap;

use serde_json::{Map, Value};
use volgraph_volume::{Trouble, VolumeError};

/// Most levels of an image.
const MOST_LEVELS: usize = 64;

/// An image in levels of resolution.
#[derive(Debug)]
pub(super) struct Image {
    pub version: String,
    pub name: Option<String>,
    pub axes: Vec<Axis>,
    /// Finest first.
    pub levels: Vec<Level>,
    /// Label and colour of each channel.
    pub channels: Vec<(String, String)>,
    /// Names of labels, where the image is one of labels.
    pub labels: Option<BTreeMap<i64, String>>,
    /// Whether the channels are red, green, blue and alpha to be drawn as they are.
    pub colors: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub name: String,
    pub kind: Kind,
    pub unit: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Space,
    Time,
    Other,
}

/// An array and where it lies: `scale * index + translation` along each axis.
#[derive(Debug)]
pub(super) struct Level {
    pub path: String,
    pub scale: Vec<f64>,
    pub translation: Vec<f64>,
}

fn bad(what: impl Into<String>) -> VolumeError {
    VolumeError::BadValue(Trouble::new(
        what,
        "correct the attributes, or write the image again",
    ))
}

impl Axis {
    fn of(value: &Value) -> Option<Self> {
        let (name, said, unit) = match value {
            Value::String(name) => (name.as_str(), None, None),
            _ => (
                value.get("name")?.as_str()?,
                value.get("type").and_then(Value::as_str),
                value.get("unit").and_then(Value::as_str),
            ),
        };
        Some(Self {
            name: name.to_owned(),
            kind: kind(said, name),
            unit: unit.map(str::to_owned),
        })
    }
}

/// By the type, else by the name.
pub(super) fn kind(said: Option<&str>, name: &str) -> Kind {
    match (said, name.to_ascii_lowercase().as_str()) {
        (Some("space"), _) | (None, "x" | "y" | "z") => Kind::Space,
        (Some("time"), _) | (None, "t" | "time") => Kind::Time,
        _ => Kind::Other,
    }
}

/// The part of the attributes that OME speaks in.
fn ome(attributes: &Map<String, Value>) -> &Map<String, Value> {
    attributes
        .get("ome")
        .and_then(Value::as_object)
        .unwrap_or(attributes)
}

/// Whether a group has images.
pub(super) fn is_image(attributes: &Map<String, Value>) -> bool {
    let multiscales = ome(attributes).get("multiscales").and_then(Value::as_array);
    multiscales.is_some_and(|list| !list.is_empty())
}

/// Names of the label images that a group of labels lists.
pub(super) fn listed_labels(attributes: &Map<String, Value>) -> Vec<String> {
    let list = ome(attributes).get("labels").and_then(Value::as_array);
    let names = list.into_iter().flatten().filter_map(Value::as_str);
    names.take(1000).map(str::to_owned).collect()
}

/// The first image of a group.
pub(super) fn image(attributes: &Map<String, Value>) -> Result<Image, VolumeError> {
    let ome = ome(attributes);
    let first = ome.get("multiscales").and_then(|list| list.get(0));
    let first = first.ok_or_else(|| bad("`multiscales` is empty"))?;
    let text = |value: &Value, key: &str| value.get(key).and_then(Value::as_str).map(str::to_owned);
    let version = ome
        .get("version")
        .and_then(Value::as_str)
        .map(str::to_owned);
    let version = version
        .or_else(|| text(first, "version"))
        .unwrap_or_default();
    let axes = match first.get("axes") {
        Some(Value::Array(axes)) => {
            let axes: Option<Vec<Axis>> = axes.iter().map(Axis::of).collect();
            axes.ok_or_else(|| bad("an axis of `multiscales` has no name"))?
        }
        _ => {
            let names = ["t", "c", "z", "y", "x"].map(|name| Value::String(name.to_owned()));
            names.iter().filter_map(Axis::of).collect()
        }
    };
    let datasets = first.get("datasets").and_then(Value::as_array);
    let datasets = datasets.filter(|list| (1..=MOST_LEVELS).contains(&list.len()));
    let datasets = datasets.ok_or_else(|| {
        bad(format!(
            "`multiscales` has no `datasets`, or more than {MOST_LEVELS}"
        ))
    })?;
    let of_all = first.get("coordinateTransformations");
    let level = |dataset: &Value| {
        let path = text(dataset, "path").ok_or_else(|| bad("a dataset has no `path`"))?;
        let mut level = Level {
            path,
            scale: vec![1.0; axes.len()],
            translation: vec![0.0; axes.len()],
        };
        level.transform(dataset.get("coordinateTransformations"))?;
        level.transform(of_all)?;
        Ok(level)
    };
    let levels: Vec<Level> = datasets
        .iter()
        .map(level)
        .collect::<Result<_, VolumeError>>()?;
    let channels = ome
        .get("omero")
        .and_then(|omero| omero.get("channels"))
        .and_then(Value::as_array);
    let channels = channels.into_iter().flatten().take(1000).map(|channel| {
        let said = |key| text(channel, key).unwrap_or_default();
        (said("label"), said("color"))
    });
    let own = ome
        .get("volgraph")
        .and_then(|own| own.get("colors"))
        .and_then(Value::as_str);
    Ok(Image {
        version,
        name: text(first, "name").filter(|name| !name.is_empty()),
        levels,
        channels: channels.collect(),
        labels: ome.get("image-label").map(label_names),
        colors: own == Some("rgba"),
        axes,
    })
}

impl Level {
    fn transform(&mut self, list: Option<&Value>) -> Result<(), VolumeError> {
        for step in list.and_then(Value::as_array).into_iter().flatten() {
            let kind = step.get("type").and_then(Value::as_str).unwrap_or_default();
            let numbers = || -> Result<Vec<f64>, VolumeError> {
                let list = step.get(kind).and_then(Value::as_array);
                let list: Option<Vec<f64>> =
                    list.and_then(|list| list.iter().map(Value::as_f64).collect());
                list.filter(|list| list.len() == self.scale.len())
                    .ok_or_else(|| {
                        bad(format!(
                            "a {kind} of {:?} has not {} numbers",
                            self.path,
                            self.scale.len()
                        ))
                    })
            };
            match kind {
                "identity" => {}
                "scale" => {
                    for (i, factor) in numbers()?.into_iter().enumerate() {
                        self.scale[i] *= factor;
                        self.translation[i] *= factor;
                    }
                }
                "translation" => {
                    let shift = numbers()?;
                    self.translation
                        .iter_mut()
                        .zip(shift)
                        .for_each(|(sum, shift)| *sum += shift);
                }
                _ => {
                    return Err(VolumeError::Unsupported(Trouble::new(
                        format!("the transformation {kind:?} of {:?} is not read", self.path),
                        "place the image by `scale` and `translation`",
                    )));
                }
            }
        }
        Ok(())
    }
}

fn label_names(image_label: &Value) -> BTreeMap<i64, String> {
    let properties = image_label.get("properties").and_then(Value::as_array);
    let names = properties.into_iter().flatten().filter_map(|property| {
        let label = property.get("label-value")?.as_i64()?;
        let name = ["name", "label", "class", "label-name"]
            .iter()
            .find_map(|key| property.get(key)?.as_str());
        Some((label, name.unwrap_or_default().to_owned()))
    });
    names.take(65_536).collect()
}

/// A unit as it is drawn.
pub(super) fn short_unit(unit: &str) -> String {
    let short = match unit {
        "angstrom" => "Å",
        "nanometer" => "nm",
        "micrometer" => "µm",
        "millimeter" => "mm",
        "centimeter" => "cm",
        "meter" => "m",
        "kilometer" => "km",
        "millisecond" => "ms",
        "second" => "s",
        "minute" => "min",
        "hour" => "h",
        other => other,
    };
    short.to_owned()
}
