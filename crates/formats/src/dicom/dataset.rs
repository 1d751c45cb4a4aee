//! The elements of a DICOM file that are of use here, and where its pixels lie.
//!
//! The file meta group is walked through by hand (it is always explicit and little-endian); then the crate
//! `dicom-parser` tells elements and sequences of the transfer syntax apart. It allocates what a header promises, so
//! each length is held against the end of the file before a value is read, and only values that are wanted are read.
//! At the pixel data it stops: its place is noted, or the places of its fragments.

use dicom_core::Tag;
use dicom_core::header::HasLength as _;
use dicom_dictionary_std::tags;
use dicom_parser::dataset::LazyDataToken;
use dicom_parser::dataset::lazy_read::LazyDataSetReader;
use dicom_parser::stateful::decode::StatefulDecode as _;
use dicom_transfer_syntax_registry::{TransferSyntaxIndex as _, TransferSyntaxRegistry};
use volgraph_volume::{Trouble, VolumeError};

use super::elements::{Dataset, Value};
use crate::input::{BufReadSeek, Input};

/// Most bytes of a value; none that is wanted is as long.
const LONGEST_VALUE: u32 = 1 << 22;
/// How deep sequences may lie in each other.
const DEEPEST: usize = 16;
/// Most fragments of compressed pixels.
const MOST_FRAGMENTS: usize = 1_000_000;

/// Elements and sequences that are read; all others are passed over.
#[rustfmt::skip]
const WANTED: &[Tag] = &[
    tags::IMAGE_TYPE, tags::SOP_CLASS_UID, tags::MODALITY, tags::SERIES_DESCRIPTION,
    tags::STUDY_DESCRIPTION, tags::SERIES_INSTANCE_UID, tags::SERIES_NUMBER, tags::INSTANCE_NUMBER,
    tags::SLICE_THICKNESS, tags::SPACING_BETWEEN_SLICES, tags::IMAGE_POSITION_PATIENT,
    tags::IMAGE_ORIENTATION_PATIENT, tags::PIXEL_SPACING, tags::IMAGER_PIXEL_SPACING,
    tags::NOMINAL_SCANNED_PIXEL_SPACING, tags::SAMPLES_PER_PIXEL, tags::PHOTOMETRIC_INTERPRETATION,
    tags::PLANAR_CONFIGURATION, tags::NUMBER_OF_FRAMES, tags::ROWS, tags::COLUMNS, tags::BITS_ALLOCATED,
    tags::BITS_STORED, tags::HIGH_BIT, tags::PIXEL_REPRESENTATION, tags::PIXEL_PADDING_VALUE,
    tags::RESCALE_SLOPE, tags::RESCALE_INTERCEPT, tags::RESCALE_TYPE, tags::UNITS, tags::BODY_PART_EXAMINED,
    tags::TEMPORAL_POSITION_IDENTIFIER, tags::TEMPORAL_RESOLUTION, tags::TEMPORAL_POSITION_INDEX,
    tags::FRAME_TIME, tags::LOSSY_IMAGE_COMPRESSION, tags::EXTENDED_OFFSET_TABLE,
    tags::SHARED_FUNCTIONAL_GROUPS_SEQUENCE, tags::PER_FRAME_FUNCTIONAL_GROUPS_SEQUENCE,
    tags::PIXEL_MEASURES_SEQUENCE, tags::PLANE_POSITION_SEQUENCE, tags::PLANE_ORIENTATION_SEQUENCE,
    tags::PIXEL_VALUE_TRANSFORMATION_SEQUENCE, tags::FRAME_CONTENT_SEQUENCE,
    tags::SEGMENT_IDENTIFICATION_SEQUENCE, tags::REFERENCED_SEGMENT_NUMBER, tags::SEGMENT_SEQUENCE,
    tags::SEGMENT_NUMBER, tags::SEGMENT_LABEL, tags::SEGMENTATION_TYPE, tags::GRID_FRAME_OFFSET_VECTOR,
    tags::DOSE_GRID_SCALING, tags::DOSE_UNITS, tags::CONVOLUTION_KERNEL, tags::MAGNETIC_FIELD_STRENGTH,
    tags::ECHO_TIME, tags::REPETITION_TIME, tags::KVP,
];

/// Where the pixels are.
#[derive(Clone, Debug)]
pub(super) enum Pixels {
    /// Bytes from an offset on.
    Native { offset: u64, len: u64 },
    /// Compressed fragments, offset and length each; and where the first fragment of each frame begins behind the
    /// first one, if the file says it.
    Fragments {
        starts: Vec<u64>,
        parts: Vec<(u64, u64)>,
    },
}

/// How the pixels of a file are numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Samples {
    Integers,
    Floats,
    Doubles,
}

/// A file that was read up to its pixels.
pub(super) struct File {
    /// Unique identifier of the transfer syntax.
    pub syntax: String,
    pub data: Dataset,
    pub pixels: Option<(Samples, Pixels)>,
}

fn broken(cause: String) -> VolumeError {
    VolumeError::HeaderSyntax(Trouble::new(
        cause,
        "fetch the file again, or export it anew",
    ))
}

/// Whether a file with this head is DICOM: with preamble, without it, or a bare data set.
pub(crate) fn is_dicom(head: &[u8]) -> bool {
    head.get(128..132) == Some(b"DICM") || meta_start(head).is_some()
}

/// Where the meta group or a bare data set begins, if the head shows one.
fn meta_start(head: &[u8]) -> Option<u64> {
    if head.get(128..132) == Some(b"DICM") {
        return Some(132);
    }
    if head.starts_with(b"DICM\x02\0") {
        return Some(4);
    }
    if head.starts_with(b"\x02\0\0\0UL\x04\0") || head.starts_with(b"\x02\0\x01\0OB") {
        return Some(0);
    }
    bare_syntax(head).map(|_| 0)
}

/// The transfer syntax of a bare data set: its first element is one of group 8.
fn bare_syntax(head: &[u8]) -> Option<&'static str> {
    let start: &[u8; 8] = head.get(..8)?.try_into().ok()?;
    let [8, 0, element, 0, rest @ ..] = *start else {
        return None;
    };
    if ![0x00, 0x05, 0x08, 0x12, 0x16, 0x18].contains(&element) {
        return None;
    }
    match rest {
        [b'A'..=b'Z', b'A'..=b'Z', len, 0] if len % 2 == 0 => Some(EXPLICIT),
        // The group's length has four bytes; others are short and even.
        [4, 0, 0, 0] if element == 0 => Some(IMPLICIT),
        [len, 0, 0, 0] if element != 0 && len % 2 == 0 && len < 128 => Some(IMPLICIT),
        _ => None,
    }
}

pub(super) const IMPLICIT: &str = "1.2.840.10008.1.2";
pub(super) const EXPLICIT: &str = "1.2.840.10008.1.2.1";
pub(super) const BIG_ENDIAN: &str = "1.2.840.10008.1.2.2";

impl File {
    pub fn read(input: &Input<'_>) -> Result<Self, VolumeError> {
        let head = input.head(132)?;
        let start = meta_start(&head).ok_or_else(|| broken("this is no DICOM file".into()))?;
        let (syntax, begin) = match bare_syntax(&head) {
            Some(syntax) if start == 0 => (syntax.to_owned(), 0),
            _ => read_meta(input, start)?,
        };
        if syntax == "1.2.840.10008.1.2.1.99" {
            return Err(VolumeError::Unsupported(Trouble::new(
                "the whole data set is deflated",
                "export the series as Explicit VR Little Endian",
            )));
        }
        let known = TransferSyntaxRegistry.get(&syntax).ok_or_else(|| {
            VolumeError::Unsupported(Trouble::new(
                format!("the transfer syntax {syntax:?} is not known here"),
                "export the series as Explicit VR Little Endian",
            ))
        })?;
        let mut source = input.open_seek()?;
        let jumped = source.seek(std::io::SeekFrom::Start(begin));
        jumped.map_err(|error| input.unreadable(&error))?;
        let reader = LazyDataSetReader::new_with_ts(source, known)
            .map_err(|error| broken(format!("the data set cannot be read: {error}")))?;
        let mut walk = Walk {
            reader,
            input,
            big_endian: syntax == BIG_ENDIAN,
            pixels: None,
        };
        let data = walk.dataset(0)?;
        let Walk { pixels, reader, .. } = walk;
        let pixels = match pixels {
            Some((samples, offset, Some(len))) => Some((
                samples,
                Pixels::Native {
                    offset,
                    len: len.into(),
                },
            )),
            Some((samples, _, None)) => {
                Some((samples, fragments(input, reader.into_decoder().position())?))
            }
            None => None,
        };
        Ok(Self {
            syntax,
            data,
            pixels,
        })
    }
}

/// The transfer syntax, and where the data set begins.
fn read_meta(input: &Input<'_>, start: u64) -> Result<(String, u64), VolumeError> {
    let mut at = start;
    let mut syntax = None;
    while at + 8 <= input.len {
        let head = input.bytes_at(at, 8)?;
        if head[..2] != [2, 0] {
            break;
        }
        let long = matches!(
            &head[4..6],
            b"OB" | b"OW" | b"UN" | b"UT" | b"SQ" | b"UC" | b"UR"
        );
        let (len, begin) = if long {
            let len = input.bytes_at(at + 8, 4)?;
            (
                u32::from_le_bytes([len[0], len[1], len[2], len[3]]).into(),
                at + 12,
            )
        } else {
            (u64::from(u16::from_le_bytes([head[6], head[7]])), at + 8)
        };
        // Bounded by the file's length.
        if head[2..4] == [0x10, 0] {
            let value = input.bytes_at(begin, len.min(128))?;
            let text = String::from_utf8_lossy(&value);
            syntax = Some(text.trim_matches(['\0', ' ']).to_owned());
        }
        at = begin + len;
    }
    let syntax =
        syntax.ok_or_else(|| broken("the file meta group names no transfer syntax".into()))?;
    Ok((syntax, at))
}

type Reader<'a> = LazyDataSetReader<
    dicom_parser::stateful::decode::DynStatefulDecoder<Box<dyn BufReadSeek + 'a>>,
>;

/// The way through a data set.
struct Walk<'s, 'a> {
    reader: Reader<'a>,
    input: &'s Input<'a>,
    big_endian: bool,
    /// Offset and length where they are known; fragments begin where the reader stands.
    pixels: Option<(Samples, u64, Option<u32>)>,
}

impl Walk<'_, '_> {
    /// The elements to the end of the item, or of the file at depth 0, or to the pixels there.
    fn dataset(&mut self, depth: usize) -> Result<Dataset, VolumeError> {
        if depth > DEEPEST {
            return Err(broken(format!(
                "more than {DEEPEST} sequences lie in each other"
            )));
        }
        let end = self.input.len;
        let mut data = Dataset::default();
        loop {
            let token = match self.reader.advance() {
                None if depth == 0 => return Ok(data),
                None => return Err(broken("the file ends in the middle of a sequence".into())),
                Some(Err(error)) => {
                    return Err(broken(format!("the data set cannot be read: {error}")));
                }
                Some(Ok(token)) => token,
            };
            match token {
                LazyDataToken::ElementHeader(_) => {}
                LazyDataToken::LazyValue { header, decoder } => {
                    let (tag, at) = (header.tag, decoder.position());
                    let len = header.length().get().unwrap_or(u32::MAX);
                    let cut = at.saturating_add(len.into()) > end;
                    if let (Some(samples), 0) = (samples_of(tag), depth) {
                        self.pixels = Some((samples, at, Some(len)));
                        return Ok(data);
                    }
                    if cut {
                        return Err(VolumeError::DataTooShort(Trouble::new(
                            format!(
                                "the element {tag} promises {len} bytes, behind it the file has {}",
                                end.saturating_sub(at)
                            ),
                            "the file is cut off: fetch it again",
                        )));
                    }
                    let failed =
                        |error| broken(format!("the element {tag} cannot be read: {error}"));
                    if WANTED.contains(&tag) && len <= LONGEST_VALUE {
                        let mut bytes = Vec::new();
                        decoder.read_to_vec(len, &mut bytes).map_err(failed)?;
                        let value = Value::Bytes {
                            vr: header.vr,
                            bytes,
                            big_endian: self.big_endian,
                        };
                        data.elements.insert(tag, value);
                    } else {
                        decoder.skip_bytes(len).map_err(failed)?;
                    }
                }
                LazyDataToken::SequenceStart { tag, .. } => {
                    let items = self.items(depth)?;
                    if WANTED.contains(&tag) {
                        data.elements.insert(tag, Value::Items(items));
                    }
                }
                LazyDataToken::ItemEnd if depth > 0 => return Ok(data),
                LazyDataToken::PixelSequenceStart if depth == 0 => {
                    self.pixels = Some((Samples::Integers, 0, None));
                    return Ok(data);
                }
                other => return Err(broken(format!("an unexpected {other:?} in the data set"))),
            }
        }
    }

    fn items(&mut self, depth: usize) -> Result<Vec<Dataset>, VolumeError> {
        let mut items = Vec::new();
        loop {
            match self.reader.advance() {
                Some(Ok(LazyDataToken::ItemStart { .. })) => items.push(self.dataset(depth + 1)?),
                Some(Ok(LazyDataToken::SequenceEnd)) => return Ok(items),
                Some(Ok(other)) => {
                    return Err(broken(format!("an unexpected {other:?} in a sequence")));
                }
                Some(Err(error)) => {
                    return Err(broken(format!("a sequence cannot be read: {error}")));
                }
                None => return Err(broken("the file ends in the middle of a sequence".into())),
            }
        }
    }
}

fn samples_of(tag: Tag) -> Option<Samples> {
    match tag {
        tags::PIXEL_DATA => Some(Samples::Integers),
        tags::FLOAT_PIXEL_DATA => Some(Samples::Floats),
        tags::DOUBLE_FLOAT_PIXEL_DATA => Some(Samples::Doubles),
        _ => None,
    }
}

/// The fragments of compressed pixels, whose first item is a table of offsets.
fn fragments(input: &Input<'_>, mut at: u64) -> Result<Pixels, VolumeError> {
    let mut items = Vec::new();
    loop {
        if at + 8 > input.len {
            // Some writers forget the delimiter.
            break;
        }
        let head = input.bytes_at(at, 8)?;
        let len = u64::from(u32::from_le_bytes([head[4], head[5], head[6], head[7]]));
        match head[..4] {
            [0xfe, 0xff, 0x00, 0xe0] => {}
            [0xfe, 0xff, 0xdd, 0xe0] => break,
            _ => {
                return Err(broken(format!(
                    "there is no fragment of pixels at byte {at}"
                )));
            }
        }
        if at + 8 + len > input.len || items.len() >= MOST_FRAGMENTS {
            return Err(VolumeError::DataTooShort(Trouble::new(
                format!(
                    "a fragment of compressed pixels has {len} bytes, the file ends before that"
                ),
                "the file is cut off: fetch it again",
            )));
        }
        items.push((at + 8, len));
        at += 8 + len;
    }
    if items.is_empty() {
        return Err(broken("the compressed pixels have no fragments".into()));
    }
    let (table_at, table_len) = items.remove(0);
    let table = input.bytes_at(table_at, table_len)?;
    let starts = table.chunks_exact(4);
    let starts = starts.map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]).into());
    Ok(Pixels::Fragments {
        starts: starts.collect(),
        parts: items,
    })
}
