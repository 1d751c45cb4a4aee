//! Which frames make a volume: those of one series that have the same size, kind of pixels and orientation.

use dicom_dictionary_std::tags;
use glam::DVec3;
use volgraph_volume::{Trouble, VolumeError};

use super::image::{Frame, Image};

/// Most groups that an error lists.
const MOST_LISTED: usize = 40;

/// Frames that make a volume.
pub(super) struct Group {
    /// Image and frame, in the order of their numbers.
    pub members: Vec<(usize, usize)>,
}

/// The one group there is, or the one that `part` names.
pub(super) fn pick(images: &[Image], part: Option<&str>) -> Result<Group, VolumeError> {
    let mut groups: Vec<Group> = Vec::new();
    for (i, image) in images.iter().enumerate() {
        for (f, frame) in image.frames.iter().enumerate() {
            let fits = |group: &&mut Group| {
                let (of, at) = group.members[0];
                alike(image, frame, &images[of], &images[of].frames[at])
            };
            match groups.iter_mut().find(fits) {
                Some(group) => group.members.push((i, f)),
                None => groups.push(Group {
                    members: vec![(i, f)],
                }),
            }
        }
    }
    for group in &mut groups {
        // Stable: files without numbers keep the order of their names.
        group
            .members
            .sort_by(|a, b| images[a.0].number.total_cmp(&images[b.0].number));
    }
    let labels: Vec<String> = groups.iter().map(|group| label(images, group)).collect();
    let fits: Vec<usize> = match part {
        None => (0..groups.len()).collect(),
        Some(part) => {
            let lower = part.to_lowercase();
            let named = |i: &usize| {
                let series = &images[groups[*i].members[0].0].series;
                labels[*i].to_lowercase().contains(&lower) || series == part
            };
            let exact = labels.iter().position(|label| label == part);
            exact.map_or_else(|| (0..groups.len()).filter(named).collect(), |i| vec![i])
        }
    };
    if let [one] = fits.as_slice() {
        return Ok(groups.swap_remove(*one));
    }
    let mut listed: Vec<&str> = labels
        .iter()
        .take(MOST_LISTED)
        .map(String::as_str)
        .collect();
    if labels.len() > MOST_LISTED {
        listed.push("and more");
    }
    let count = labels.len();
    Err(VolumeError::Option(Trouble::new(
        match part {
            None => format!("there are {count} series here: {}", listed.join("; ")),
            Some(part) => format!(
                "{part:?} names {} of the {count} series here: {}",
                fits.len(),
                listed.join("; ")
            ),
        },
        "name one of them with the option `part`: a part of its text that no other has, or its SeriesInstanceUID",
    )))
}

fn alike(a: &Image, frame: &Frame, b: &Image, other: &Frame) -> bool {
    let close = |a: Option<[DVec3; 2]>, b: Option<[DVec3; 2]>| match (a, b) {
        (Some(a), Some(b)) => a.iter().zip(b).all(|(a, b)| a.distance(b) < 1e-3),
        (a, b) => a.is_none() && b.is_none(),
    };
    let near = |a: Option<[f64; 2]>, b: Option<[f64; 2]>| match (a, b) {
        (Some(a), Some(b)) => a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3 * b),
        (a, b) => a.is_none() && b.is_none(),
    };
    let pixels = |image: &Image| {
        let color = image.samples;
        (
            image.rows,
            image.columns,
            color,
            image.scalar_type(),
            image.photometric == "MONOCHROME1",
        )
    };
    a.series == b.series
        && pixels(a) == pixels(b)
        && frame.position.is_some() == other.position.is_some()
        && close(frame.orientation, other.orientation)
        && near(frame.spacing, other.spacing)
}

/// `3 Head, CT, axial 512×512, 93 slices`.
fn label(images: &[Image], group: &Group) -> String {
    let (first, frame) = group.members[0];
    let image = &images[first];
    let number = image
        .data
        .count(tags::SERIES_NUMBER)
        .map(|number| number.to_string());
    let description = image.data.text(tags::SERIES_DESCRIPTION);
    let title: Vec<String> = [number, description].into_iter().flatten().collect();
    let title = if title.is_empty() {
        "unnamed".to_owned()
    } else {
        title.join(" ")
    };
    let modality = image
        .data
        .text(tags::MODALITY)
        .unwrap_or_else(|| "unknown modality".into());
    let plane = image.frames[frame].orientation.map_or("", |[x, y]| {
        let normal = x.cross(y).normalize_or_zero().abs();
        match normal.max_element() {
            most if most < 0.9 => "oblique ",
            most if most == normal.x => "sagittal ",
            most if most == normal.y => "coronal ",
            _ => "axial ",
        }
    });
    let count = group.members.len();
    let slices = if count == 1 { "slice" } else { "slices" };
    format!(
        "{title}, {modality}, {plane}{}×{}, {count} {slices}",
        image.columns, image.rows
    )
}
