//! What a DICOM file says of its pixels, and of each of its frames: where it lies, how its values are rescaled.
//!
//! A classic file is one frame whose attributes stand in the data set itself. An enhanced one has a sequence of
//! groups per frame and one that all frames share; a frame's own group wins, then the shared one, then the data set.

use dicom_core::Tag;
use dicom_dictionary_std::tags;
use glam::DVec3;
use volgraph_volume::{ScalarType, Trouble, VolumeError};

use super::dataset::{File, Pixels, Samples};
use super::elements::Dataset;
use crate::input::Input;

/// Most frames of a file.
const MOST_FRAMES: u32 = 1_000_000;

/// Frames that may be as small as they like.
const SOME_FRAMES: u64 = 4096;

/// A file with pixels.
pub(super) struct Image {
    pub syntax: String,
    pub rows: u32,
    pub columns: u32,
    pub samples: u32,
    pub photometric: String,
    /// Samples lie plane by plane.
    pub planar: bool,
    pub allocated: u32,
    pub stored: u32,
    pub high_bit: u32,
    pub signed: bool,
    pub kind: Samples,
    pub pixels: Pixels,
    pub frames: Vec<Frame>,
    pub series: String,
    pub number: f64,
    pub data: Dataset,
}

/// Where a frame lies and what its values mean.
#[derive(Clone, Debug, Default)]
pub(super) struct Frame {
    pub position: Option<DVec3>,
    /// The directions of x and y.
    pub orientation: Option<[DVec3; 2]>,
    /// Distance between rows, and between columns.
    pub spacing: Option<[f64; 2]>,
    /// Distance to the next slice, or thickness, where one is alone.
    pub thickness: Option<f64>,
    /// Slope and intercept, where they are said.
    pub rescale: Option<[f64; 2]>,
    pub rescale_type: Option<String>,
    /// Which time step it belongs to.
    pub time: Option<u32>,
    /// Which segment it shows.
    pub segment: Option<u32>,
}

fn missing(what: &str) -> VolumeError {
    VolumeError::MissingField(Trouble::new(
        format!("the file does not say its {what}"),
        "export the series anew",
    ))
}

fn bad(cause: String) -> VolumeError {
    VolumeError::BadValue(Trouble::new(cause, "export the series anew"))
}

impl Image {
    /// The image of a file; `None` for one without pixels (a directory of files, a report).
    pub fn of(input: &Input<'_>) -> Result<Option<Self>, VolumeError> {
        let File {
            syntax,
            data,
            pixels,
        } = File::read(input)?;
        let Some((kind, pixels)) = pixels else {
            return Ok(None);
        };
        let size = |tag: Tag, what: &str| {
            let size = data.count(tag).ok_or_else(|| missing(what))?;
            match size {
                1..=65535 => Ok(size),
                _ => Err(VolumeError::Grid(Trouble::new(
                    format!("the image has {size} {what}"),
                    "give each axis at least one sample",
                ))),
            }
        };
        let (rows, columns) = (size(tags::ROWS, "rows")?, size(tags::COLUMNS, "columns")?);
        let samples = data.count(tags::SAMPLES_PER_PIXEL).unwrap_or(1);
        if ![1, 3, 4].contains(&samples) {
            return Err(bad(format!("there are {samples} samples per pixel")));
        }
        let bits = match kind {
            Samples::Integers => data
                .count(tags::BITS_ALLOCATED)
                .ok_or_else(|| missing("bits"))?,
            Samples::Floats => 32,
            Samples::Doubles => 64,
        };
        // Floats have all their bits, whatever is said of them.
        let said = |tag: Tag| data.count(tag).filter(|_| kind == Samples::Integers);
        let stored = said(tags::BITS_STORED).unwrap_or(bits);
        let high_bit = said(tags::HIGH_BIT).unwrap_or(stored.max(1) - 1);
        let fits = kind != Samples::Integers
            || [1, 8, 16, 32].contains(&bits)
                && (1..=bits).contains(&stored)
                && high_bit < bits
                && high_bit + 1 >= stored;
        if !fits {
            return Err(VolumeError::UnknownType(Trouble::new(
                format!("pixels of {bits} bits with {stored} stored, the highest is {high_bit}"),
                "export the series with 8, 16 or 32 bits",
            )));
        }
        let photometric = data.text(tags::PHOTOMETRIC_INTERPRETATION);
        let photometric = photometric.unwrap_or_else(|| "MONOCHROME2".into());
        if photometric.starts_with("PALETTE") {
            return Err(VolumeError::Unsupported(Trouble::new(
                "the pixels are numbers in a palette of colours (PALETTE COLOR)",
                "export the series as RGB or MONOCHROME2",
            )));
        }
        let mut image = Self {
            syntax,
            rows,
            columns,
            samples,
            photometric,
            planar: data.count(tags::PLANAR_CONFIGURATION) == Some(1),
            allocated: bits,
            stored,
            high_bit,
            signed: data.count(tags::PIXEL_REPRESENTATION) == Some(1),
            kind,
            pixels,
            frames: Vec::new(),
            series: data.text(tags::SERIES_INSTANCE_UID).unwrap_or_default(),
            number: data.number(tags::INSTANCE_NUMBER).unwrap_or(f64::INFINITY),
            data,
        };
        image.check_length(input)?;
        image.frames = image.read_frames()?;
        image.data.forget_frames();
        Ok(Some(image))
    }

    pub fn frame_count(data: &Dataset) -> Result<u32, VolumeError> {
        let count = data.count(tags::NUMBER_OF_FRAMES).unwrap_or(1).max(1);
        if count > MOST_FRAMES {
            return Err(VolumeError::TooLarge(Trouble::new(
                format!("the file says that it has {count} frames"),
                "give a file of fewer frames",
            )));
        }
        Ok(count)
    }

    /// Bits of one frame.
    pub fn frame_bits(&self) -> u64 {
        u64::from(self.rows)
            * u64::from(self.columns)
            * u64::from(self.samples)
            * u64::from(self.allocated)
    }

    /// Refuses a file that is too short for its frames before anything is made of their number.
    fn check_length(&self, input: &Input<'_>) -> Result<(), VolumeError> {
        let count = u64::from(Self::frame_count(&self.data)?);
        let needed = count.saturating_mul(self.frame_bits()).div_ceil(8);
        let cut_off = |cause: String| {
            VolumeError::DataTooShort(Trouble::new(
                cause,
                "the file is cut off: fetch it again, or correct its number of frames",
            ))
        };
        match &self.pixels {
            Pixels::Native { offset, len } => {
                let have = input.len.saturating_sub(*offset).min(*len);
                if have < needed {
                    return Err(cut_off(format!(
                        "holds {have} bytes of pixels; {count} frames of {}×{} need {needed}",
                        self.columns, self.rows
                    )));
                }
                // Frames of a few bits would take less than what is kept of each.
                if count > SOME_FRAMES + input.len / 64 {
                    return Err(VolumeError::TooLarge(Trouble::new(
                        format!(
                            "the file says that it has {count} frames of {}×{} pixels",
                            self.columns, self.rows
                        ),
                        "give a file of fewer and larger frames",
                    )));
                }
                Ok(())
            }
            Pixels::Fragments { parts, .. } => {
                // Runs and codes of a few bits could stand for any number of empty frames.
                if count > parts.len() as u64 {
                    return Err(cut_off(format!(
                        "has {} fragments of compressed pixels for {count} frames",
                        parts.len()
                    )));
                }
                let have = parts.iter().map(|(_, len)| len).sum();
                let codec = super::codecs::codec_of(&self.syntax)?;
                crate::slices::plausible(codec, have, needed)
            }
        }
    }

    fn read_frames(&self) -> Result<Vec<Frame>, VolumeError> {
        let count = Self::frame_count(&self.data)?;
        let groups = self.data.items(tags::PER_FRAME_FUNCTIONAL_GROUPS_SEQUENCE);
        let shared = self.data.item(tags::SHARED_FUNCTIONAL_GROUPS_SEQUENCE);
        let mut frames: Vec<Frame> = (0..count as usize)
            .map(|index| Frame::of(&self.data, shared, groups.get(index)))
            .collect();
        // A grid of dose: one position, and offsets along the normal.
        let offsets = self.data.numbers(tags::GRID_FRAME_OFFSET_VECTOR);
        if offsets.len() == frames.len() && frames.len() > 1 {
            for (frame, offset) in frames.iter_mut().zip(&offsets) {
                let [x, y] = frame.orientation.unwrap_or([DVec3::X, DVec3::Y]);
                let along = x.cross(y).normalize_or_zero() * (offset - offsets[0]);
                frame.position = frame.position.map(|position| position + along);
            }
        } else if frames.len() > 1 && groups.is_empty() {
            // One position for all frames places none of them.
            frames.iter_mut().for_each(|frame| frame.position = None);
        }
        Ok(frames)
    }

    /// The type of the values as they are stored.
    pub fn scalar_type(&self) -> ScalarType {
        match (self.kind, self.allocated, self.signed) {
            (Samples::Floats, ..) => ScalarType::F32,
            (Samples::Doubles, ..) => ScalarType::F64,
            (_, 16, false) => ScalarType::U16,
            (_, 16, true) => ScalarType::I16,
            (_, 32, false) => ScalarType::U32,
            (_, 32, true) => ScalarType::I32,
            (_, 8, true) => ScalarType::I8,
            _ => ScalarType::U8,
        }
    }

    /// The stored value of pixels that were not measured. Some files write it with the wrong sign.
    pub fn padding(&self) -> Option<f64> {
        let value = self.data.number(tags::PIXEL_PADDING_VALUE)?;
        let all = f64::from(self.allocated.min(16)).exp2();
        Some(match self.signed {
            true if value >= all / 2.0 => value - all,
            false if value < 0.0 => value + all,
            _ => value,
        })
    }

    /// The least and the greatest number that the stored bits can say.
    pub fn range(&self) -> Option<(f64, f64)> {
        if self.kind != Samples::Integers {
            return None;
        }
        let all = f64::from(self.stored).exp2();
        Some(if self.signed {
            (-all / 2.0, all / 2.0 - 1.0)
        } else {
            (0.0, all - 1.0)
        })
    }
}

fn vector([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(x, y, z)
}

impl Frame {
    fn of(data: &Dataset, shared: Option<&Dataset>, own: Option<&Dataset>) -> Self {
        // The data set that holds an attribute of a functional group.
        let group = |sequence: Tag| {
            let of_own = own.and_then(|groups| groups.item(sequence));
            of_own.or_else(|| shared.and_then(|groups| groups.item(sequence)))
        };
        let position = group(tags::PLANE_POSITION_SEQUENCE);
        let orientation = group(tags::PLANE_ORIENTATION_SEQUENCE);
        let measures = group(tags::PIXEL_MEASURES_SEQUENCE);
        let values = group(tags::PIXEL_VALUE_TRANSFORMATION_SEQUENCE);
        let content = group(tags::FRAME_CONTENT_SEQUENCE);
        let segment = group(tags::SEGMENT_IDENTIFICATION_SEQUENCE);
        let [position, orientation, measures, values] =
            [position, orientation, measures, values].map(|group| group.unwrap_or(data));
        let spacing = [
            tags::PIXEL_SPACING,
            tags::IMAGER_PIXEL_SPACING,
            tags::NOMINAL_SCANNED_PIXEL_SPACING,
        ];
        let spacing = spacing.iter().find_map(|tag| measures.array::<2>(*tag));
        let thickness = [tags::SPACING_BETWEEN_SLICES, tags::SLICE_THICKNESS];
        let thickness = thickness.iter().find_map(|tag| {
            measures
                .number(*tag)
                .map(f64::abs)
                .filter(|value| *value > 0.0)
        });
        let slope = values
            .number(tags::RESCALE_SLOPE)
            .or(data.number(tags::DOSE_GRID_SCALING));
        let intercept = values.number(tags::RESCALE_INTERCEPT);
        let rescaled = slope.is_some() || intercept.is_some();
        let time = content.and_then(|content| content.count(tags::TEMPORAL_POSITION_INDEX));
        Self {
            position: position.array(tags::IMAGE_POSITION_PATIENT).map(vector),
            orientation: orientation
                .array(tags::IMAGE_ORIENTATION_PATIENT)
                .and_then(directions),
            spacing: spacing.filter(|spacing| spacing.iter().all(|step| *step > 0.0)),
            thickness,
            rescale: rescaled.then(|| [slope.unwrap_or(1.0), intercept.unwrap_or(0.0)]),
            rescale_type: values.text(tags::RESCALE_TYPE),
            time: time.or_else(|| data.count(tags::TEMPORAL_POSITION_IDENTIFIER)),
            segment: segment.and_then(|segment| segment.count(tags::REFERENCED_SEGMENT_NUMBER)),
        }
    }
}

/// Two directions of length 1, if they are any.
fn directions([a, b, c, d, e, f]: [f64; 6]) -> Option<[DVec3; 2]> {
    let x = vector([a, b, c]).try_normalize()?;
    let y = vector([d, e, f]).try_normalize()?;
    (x.dot(y).abs() < 0.5).then_some([x, y])
}
