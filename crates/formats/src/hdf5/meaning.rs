//! Which axes of an array are space, time and components.
//!
//! Names decide: those of dimension scales (NetCDF), labels of h5py, or `axistags` of ilastik and vigra. Without them
//! the last three axes are z, y, x; of four the last one holds components where it has two to four values, else the
//! first one is time; of five the first is time and the last one holds components.

use volgraph_volume::{Trouble, VolumeError};

use super::attributes::Attributes;
use super::parts::Scale;
use crate::axes::Axes;

pub(super) struct Meaning {
    /// Place of x, y and z among the axes; fewer where there are fewer.
    pub space: Vec<usize>,
    pub time: Option<usize>,
}

/// The name of each axis, empty where it has none.
pub(super) fn names(attributes: &Attributes, scales: &[Option<Scale>]) -> Vec<String> {
    if let Some(tags) = attributes.long_text("axistags") {
        let tags: Option<serde_json::Value> = serde_json::from_str(&tags).ok();
        let axes = tags.as_ref().and_then(|tags| tags.get("axes")?.as_array());
        let keys: Option<Vec<String>> = axes.and_then(|axes| {
            let keys = axes.iter().map(|axis| axis.get("key")?.as_str());
            keys.map(|key| key.map(str::to_owned)).collect()
        });
        if let Some(keys) = keys.filter(|keys| keys.len() == scales.len()) {
            return keys;
        }
    }
    let labels = attributes.texts("DIMENSION_LABELS");
    let labels = labels.filter(|labels| labels.len() == scales.len());
    scales
        .iter()
        .enumerate()
        .map(|(i, scale)| match (scale, &labels) {
            (_, Some(labels)) if !labels[i].is_empty() => labels[i].clone(),
            (Some(scale), _) if is_time(scale) => "time".to_owned(),
            (Some(scale), _) => scale.name.clone(),
            _ => String::new(),
        })
        .collect()
}

/// NetCDF counts time `hours since 1970-01-01`.
fn is_time(scale: &Scale) -> bool {
    let unit = scale.unit.as_deref().unwrap_or_default();
    unit.contains(" since ")
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Space(usize),
    Time,
    Components,
    Unknown,
}

fn kind(name: &str) -> Kind {
    match name.to_ascii_lowercase().as_str() {
        "x" => Kind::Space(0),
        "y" => Kind::Space(1),
        "z" => Kind::Space(2),
        "t" | "time" => Kind::Time,
        "c" | "channel" | "channels" => Kind::Components,
        _ => Kind::Unknown,
    }
}

impl Meaning {
    pub fn of(shape: &[u64], names: &[String]) -> Result<Self, VolumeError> {
        let mut kinds: Vec<Kind> = names.iter().map(|name| kind(name)).collect();
        let time_of = |kinds: &[Kind]| kinds.iter().position(|kind| *kind == Kind::Time);
        let free = |kinds: &[Kind]| -> Vec<usize> {
            let axes = 0..kinds.len();
            axes.filter(|&axis| kinds[axis] == Kind::Unknown).collect()
        };
        let named =
            |kinds: &[Kind], i: usize| kinds.iter().position(|kind| *kind == Kind::Space(i));
        let by_name: Vec<usize> = (0..3).filter_map(|i| named(&kinds, i)).collect();
        let repeated = kinds.iter().filter(|kind| matches!(kind, Kind::Space(_)));
        if !by_name.is_empty() && repeated.count() == by_name.len() {
            // Of axes that are named beside x and y one more can be space: levels, depths.
            let mut space = by_name;
            if let ([axis], 2) = (free(&kinds).as_slice(), space.len()) {
                space.push(*axis);
            }
            return Ok(Self {
                space,
                time: time_of(&kinds),
            });
        }
        for kind in &mut kinds {
            if matches!(kind, Kind::Space(_)) {
                *kind = Kind::Unknown;
            }
        }
        let few = |axis: usize| (1..=4).contains(&shape[axis]);
        let nothing_known = free(&kinds).len() == kinds.len();
        if let ([first, .., last], n @ 4..) = (free(&kinds).as_slice(), free(&kinds).len()) {
            match n {
                4 if few(*last) => kinds[*last] = Kind::Components,
                4 if time_of(&kinds).is_none() => kinds[*first] = Kind::Time,
                5 if nothing_known && few(*last) => {
                    kinds[*first] = Kind::Time;
                    kinds[*last] = Kind::Components;
                }
                _ => {}
            }
        }
        let mut space = free(&kinds);
        space.reverse();
        if space.is_empty() || space.len() > 3 {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("an array of {} axes {shape:?} is no volume", shape.len()),
                "label its axes (h5py: array.dims[0].label = 't', and c, z, y, x), or save one of three axes (z, y, x)",
            )));
        }
        Ok(Self {
            space,
            time: time_of(&kinds),
        })
    }

    /// An image of ITK: `image` axes, then the components of vectors. The fourth axis is time.
    pub fn of_itk(rank: usize, image: usize) -> Result<Self, VolumeError> {
        let axes: Vec<usize> = (0..image).rev().collect();
        match (rank.checked_sub(image), image) {
            (Some(0 | 1), 1..=3) => Ok(Self {
                space: axes,
                time: None,
            }),
            (Some(0 | 1), 4) => Ok(Self {
                space: axes[..3].to_vec(),
                time: Some(0),
            }),
            _ => Err(VolumeError::Unsupported(Trouble::new(
                format!("an ITK image of {image} axes in an array of {rank}"),
                "write the image again, with one to four axes",
            ))),
        }
    }

    /// The axes as the rest of the crate has them: fastest first.
    pub fn axes(&self, shape: &[u64]) -> Result<Axes, VolumeError> {
        let turned = |axis: usize| shape.len() - 1 - axis;
        let space = self.space.iter().map(|&axis| turned(axis)).collect();
        let axes = Axes::new(shape.iter().rev().copied().collect(), space)?;
        match self.time {
            Some(time) => axes.with_time(turned(time)),
            None => Ok(axes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(shape: &[u64], names: &[&str]) -> Option<(Vec<usize>, Option<usize>)> {
        let mut all: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        all.resize(shape.len(), String::new());
        let meaning = Meaning::of(shape, &all).ok()?;
        Some((meaning.space, meaning.time))
    }

    #[test]
    fn names_go_before_numbers() {
        assert_eq!(of(&[9, 8, 7], &[]), Some((vec![2, 1, 0], None)));
        assert_eq!(
            of(&[9, 8, 7], &["x", "y", "z"]),
            Some((vec![0, 1, 2], None))
        );
        assert_eq!(of(&[9, 8, 7, 3], &[]), Some((vec![2, 1, 0], None)));
        assert_eq!(of(&[9, 8, 7, 6], &[]), Some((vec![3, 2, 1], Some(0))));
        assert_eq!(of(&[9, 8, 7, 6, 2], &[]), Some((vec![3, 2, 1], Some(0))));
        assert_eq!(
            of(&[2, 8, 7, 6], &["c", "z", "y", "x"]),
            Some((vec![3, 2, 1], None))
        );
        assert_eq!(
            of(&[5, 8, 7, 6], &["time", "level", "lat", "lon"]),
            Some((vec![3, 2, 1], Some(0)))
        );
        assert_eq!(
            of(&[5, 8, 7, 6], &["time", "level", "y", "x"]),
            Some((vec![3, 2, 1], Some(0)))
        );
        assert_eq!(of(&[9, 8, 7, 6, 5], &[]), None);
        assert_eq!(of(&[9, 8, 7, 6, 5, 2], &[]), None);
        assert_eq!(of(&[9, 3], &["t", "c"]), None);
    }
}
