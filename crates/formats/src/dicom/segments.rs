//! Segmentation objects: frames of one bit (or of labels) to a volume of labels with the segments' names.
//!
//! A binary object has a frame per segment and slice where the segment is; slices without any may be left out, so the
//! step is the smallest distance there is, and slices between are empty. Where segments overlap the one with the
//! higher number is seen, as a volume has one label per voxel. Frames of fractions are refused.

use std::collections::BTreeMap;

use dicom_dictionary_std::tags;
use glam::{DAffine3, DMat3};
use volgraph_volume::{Grid, ScalarType, Trouble, Values, VolumeError, Voxels};

use super::codecs;
use super::image::Image;
use super::series::Group;
use crate::axes::Axes;
use crate::contents::{Contents, Opened};
use crate::input::{Input, stem};
use crate::slices::{Frames, Slices};

/// Most slices that gaps are filled with: so many, and three per frame. A file's word alone shall not fill the memory.
const MOST_EMPTY: f64 = 512.0;

pub(super) fn is_segmentation(image: &Image) -> bool {
    image.data.text(tags::SEGMENTATION_TYPE).is_some()
}

fn refuse(cause: impl Into<String>) -> VolumeError {
    let remedy = "convert it to NRRD or NIfTI, as with `segimage2itkimage` of dcmqi";
    VolumeError::Unsupported(Trouble::new(cause, remedy))
}

pub(super) fn open<'a>(
    mut files: Vec<Input<'a>>,
    mut images: Vec<Image>,
    group: &Group,
) -> Result<Opened<'a>, VolumeError> {
    let at = group.members[0].0;
    if group.members.iter().any(|&(image, _)| image != at) {
        return Err(refuse("several segmentations lie in this folder"));
    }
    let (image, input) = (images.swap_remove(at), files.swap_remove(at));
    open_one(image, input.clone()).map_err(|error| error.in_file(&input.path))
}

fn open_one<'a>(image: Image, input: Input<'a>) -> Result<Opened<'a>, VolumeError> {
    let kind = image.data.text(tags::SEGMENTATION_TYPE).unwrap_or_default();
    let binary = kind == "BINARY";
    if !binary && kind != "LABELMAP" || image.samples != 1 {
        return Err(refuse(format!("a segmentation of the type {kind}")));
    }
    codecs::codec_of(&image.syntax)?;
    let place = |index: usize| {
        let frame = &image.frames[index];
        Some((frame.position?, frame.orientation?, frame.spacing?))
    };
    let first = place(0).ok_or_else(|| refuse("a segmentation without positions"))?;
    let (_, [x, y], [row_step, column_step]) = first;
    let normal = x.cross(y).normalize();
    let mut heights = Vec::new();
    for index in 0..image.frames.len() {
        let (position, ..) =
            place(index).ok_or_else(|| refuse("a segmentation without positions"))?;
        heights.push((position.dot(normal), index));
    }
    heights.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = 1e-3 * row_step.min(column_step);
    let gaps = heights
        .windows(2)
        .map(|pair| pair[1].0 - pair[0].0)
        .filter(|gap| *gap > same);
    let smallest = gaps.fold(f64::INFINITY, f64::min);
    let thickness = image.frames[0].thickness.unwrap_or(row_step);
    let step = if smallest.is_finite() {
        smallest.min(thickness.max(same))
    } else {
        thickness
    };
    let low = heights[0].0;
    let slice_of = |height: f64| ((height - low) / step).round();
    let slices = slice_of(heights[heights.len() - 1].0) + 1.0;
    let uneven = heights
        .iter()
        .any(|(height, _)| ((height - low) / step - slice_of(*height)).abs() > 0.05);
    if uneven || slices.is_nan() || slices > MOST_EMPTY + 4.0 * image.frames.len() as f64 {
        return Err(refuse(
            "the slices of the segmentation are not evenly spaced",
        ));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "seen to be from 1 to a few millions"
    )]
    let count = slices as usize;
    let mut members: Vec<Vec<(u32, usize)>> = vec![Vec::new(); count];
    for &(height, index) in &heights {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "no greater than the number of slices"
        )]
        let slice = slice_of(height) as usize;
        members[slice].push((image.frames[index].segment.unwrap_or(1), index));
    }
    members.iter_mut().for_each(|slice| slice.sort_unstable());
    let pixels = u64::from(image.rows) * u64::from(image.columns);
    let axes = Axes::new(
        vec![image.columns.into(), image.rows.into(), count as u64],
        vec![0, 1, 2],
    )?;
    let origin = image.frames[heights[0].1].position.unwrap_or_default();
    let grid = Grid {
        dims: axes.dims(),
        world_from_index: DAffine3 {
            matrix3: DMat3::from_cols(x * column_step, y * row_step, normal * step),
            translation: origin,
        },
        node_centred: false,
    };
    let scalar_type = if binary {
        ScalarType::U16
    } else {
        image.scalar_type()
    };
    let mut contents = Contents::new("DICOM SEG", stem(&input.path), axes, scalar_type, grid);
    contents.about.length_unit = Some("mm".into());
    contents.about.values = Values::Labels(names(&image));
    if let Some(text) = image.data.text(tags::SERIES_DESCRIPTION) {
        contents.about.facts.push(("series".into(), text));
    }
    let what = contents.axes.describe(scalar_type);
    let data = Slices {
        order: (0..count).collect(),
        per_step: count,
        values: pixels,
        scalar_type,
        what,
        frames: Segments {
            input,
            image,
            members,
            binary,
        },
    };
    Ok(Opened {
        contents,
        data: Box::new(data),
    })
}

/// The segments' names by their numbers.
fn names(image: &Image) -> BTreeMap<i64, String> {
    let segments = image.data.items(tags::SEGMENT_SEQUENCE).iter();
    let named = segments.filter_map(|segment| {
        Some((
            segment.count(tags::SEGMENT_NUMBER)?.into(),
            segment.text(tags::SEGMENT_LABEL)?,
        ))
    });
    named.collect()
}

struct Segments<'a> {
    input: Input<'a>,
    image: Image,
    /// Segment and frame of each slice.
    members: Vec<Vec<(u32, usize)>>,
    binary: bool,
}

impl Frames for Segments<'_> {
    fn decode(&self, slice: usize) -> Result<Voxels, VolumeError> {
        let decode = |frame| {
            codecs::decode(&self.input, &self.image, frame).map_err(|e| e.in_file(&self.input.path))
        };
        let count = self.image.rows as usize * self.image.columns as usize;
        if !self.binary {
            return match (self.members[slice].first(), self.image.scalar_type()) {
                (Some(&(_, frame)), _) => decode(frame),
                (None, ScalarType::U16) => Ok(Voxels::U16(vec![0; count])),
                (None, _) => Ok(Voxels::U8(vec![0; count])),
            };
        }
        let mut labels = vec![0_u16; count];
        for &(segment, frame) in &self.members[slice] {
            let segment = u16::try_from(segment).unwrap_or(u16::MAX);
            let Voxels::U8(bits) = decode(frame)? else {
                return Err(refuse("a binary segmentation of more than 8 bits"));
            };
            for (label, bit) in labels.iter_mut().zip(bits) {
                if bit != 0 {
                    *label = segment;
                }
            }
        }
        Ok(Voxels::U16(labels))
    }
}
