//! The elements of the file, one after the other, as they pass.
//!
//! The text of an array is passed over, only its place is kept: it may be most of the file. The appended data is where
//! parsing ends.

use std::io::{BufRead, Read as _};

use glam::{DMat3, DVec3};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use volgraph_volume::{Trouble, VolumeError};

use super::blocks::sentence;
use super::header::{Array, Compressor, Extent, Header, On, Piece, Place, bad};
use crate::input::Input;

/// Most arrays in all pieces together.
const MOST_ARRAYS: usize = 100_000;
/// Most bytes of a time that is shown as it is.
const LONGEST_TIME: u64 = 64;

/// Reads the file up to its end, or up to the appended data.
pub(super) fn read(input: &Input<'_>) -> Result<Header, VolumeError> {
    let mut scan = Scan {
        input,
        header: Header::default(),
        section: Section::Outside,
        arrays: 0,
        image: false,
    };
    let mut xml = Reader::from_reader(input.open(0)?);
    let mut buffer = Vec::new();
    let broken = |error: &dyn std::fmt::Display, at: u64| {
        VolumeError::HeaderSyntax(Trouble::new(
            format!("the XML cannot be read at byte {at}: {}", sentence(error)),
            "fetch the file again",
        ))
    };
    loop {
        buffer.clear();
        let event = match xml.read_event_into(&mut buffer) {
            Ok(event) => event,
            Err(error) => return Err(broken(&error, xml.error_position())),
        };
        match event {
            Event::Eof => {
                return Err(VolumeError::DataTooShort(Trouble::new(
                    "the file ends before </VTKFile>",
                    "the file is cut off: fetch it again",
                )));
            }
            Event::End(tag) if tag.name().as_ref() == b"VTKFile" => break,
            Event::End(tag) => {
                if matches!(
                    tag.name().as_ref(),
                    b"PointData" | b"CellData" | b"FieldData"
                ) {
                    scan.section = Section::Outside;
                }
            }
            Event::Empty(tag) => {
                scan.element(&tag, (0, 0))?;
                scan.section = if tag.name().as_ref() == b"DataArray" {
                    scan.section
                } else {
                    Section::Outside
                };
            }
            Event::Start(tag) if tag.name().as_ref() == b"DataArray" => {
                let from = xml.buffer_position();
                let len =
                    pass(&mut xml.stream(), b'<').map_err(|error| input.unreadable(&error))?;
                scan.element(&tag, (from, len))?;
            }
            Event::Start(tag) if tag.name().as_ref() == b"AppendedData" => {
                let base64 = attribute(&tag, "encoding")?.is_none_or(|encoding| encoding != "raw");
                pass(&mut xml.stream(), b'_').map_err(|error| input.unreadable(&error))?;
                scan.header.coding.appended = Some((xml.buffer_position() + 1, base64));
                break;
            }
            Event::Start(tag) => scan.element(&tag, (0, 0))?,
            _ => {}
        }
    }
    scan.finish()
}

/// Passes over everything before a byte; gives how much that was.
fn pass(stream: &mut impl BufRead, until: u8) -> std::io::Result<u64> {
    let mut passed = 0;
    loop {
        let buffer = stream.fill_buf()?;
        let found = buffer.iter().position(|&byte| byte == until);
        let used = found.unwrap_or(buffer.len());
        stream.consume(used);
        passed += used as u64;
        if found.is_some() || used == 0 {
            return Ok(passed);
        }
    }
}

fn attribute(tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, VolumeError> {
    let broken = |error: &dyn std::fmt::Display| {
        VolumeError::HeaderSyntax(Trouble::new(
            format!("the attribute {name} cannot be read: {}", sentence(error)),
            "fetch the file again",
        ))
    };
    let found = tag
        .try_get_attribute(name)
        .map_err(|error| broken(&error))?;
    let value = found.map(|found| {
        found
            .decoded_and_normalized_value(XmlVersion::Implicit1_0, tag.decoder())
            .map(std::borrow::Cow::into_owned)
    });
    value.transpose().map_err(|error| broken(&error))
}

/// Numbers of an attribute.
fn numbers<T: std::str::FromStr, const N: usize>(
    tag: &BytesStart<'_>,
    name: &str,
) -> Result<Option<[T; N]>, VolumeError> {
    let Some(text) = attribute(tag, name)? else {
        return Ok(None);
    };
    let numbers: Vec<T> = text
        .split_whitespace()
        .map_while(|word| word.parse().ok())
        .collect();
    let whole = text.split_whitespace().count() == N;
    match numbers.try_into() {
        Ok(numbers) if whole => Ok(Some(numbers)),
        _ => {
            let shown: String = text.chars().take(60).collect();
            Err(bad(
                format!("{name}={shown:?} are not {N} numbers that fit"),
                "correct the attribute",
            ))
        }
    }
}

fn extent(tag: &BytesStart<'_>, name: &str) -> Result<Extent, VolumeError> {
    let [a, b, c, d, e, f] = numbers(tag, name)?.ok_or_else(|| {
        VolumeError::MissingField(Trouble::new(
            format!("an element has no {name}"),
            "write first and last point of each axis there",
        ))
    })?;
    Ok([[a, b], [c, d], [e, f]])
}

/// Where an element stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Outside,
    On(On),
    Field,
}

/// What was seen so far.
struct Scan<'s, 'a> {
    input: &'s Input<'a>,
    header: Header,
    section: Section,
    arrays: usize,
    image: bool,
}

impl Scan<'_, '_> {
    /// Takes an element down; `text` is where the text behind its tag begins, and its length.
    fn element(&mut self, tag: &BytesStart<'_>, text: (u64, u64)) -> Result<(), VolumeError> {
        match tag.name().as_ref() {
            b"VTKFile" => self.file(tag),
            b"ImageData" => {
                self.image = true;
                self.header.extent = extent(tag, "WholeExtent")?;
                self.header.origin = DVec3::from_array(numbers(tag, "Origin")?.unwrap_or([0.0; 3]));
                self.header.spacing =
                    DVec3::from_array(numbers(tag, "Spacing")?.unwrap_or([1.0; 3]));
                let rows: Option<[f64; 9]> = numbers(tag, "Direction")?;
                self.header.direction = rows.map_or(DMat3::IDENTITY, |rows| {
                    DMat3::from_cols_array(&rows).transpose()
                });
                Ok(())
            }
            b"Piece" => {
                self.count()?;
                self.header.pieces.push(Piece {
                    extent: extent(tag, "Extent")?,
                    ..Piece::default()
                });
                Ok(())
            }
            b"PointData" => self.data(tag, On::Points),
            b"CellData" => self.data(tag, On::Cells),
            b"FieldData" => {
                self.section = Section::Field;
                Ok(())
            }
            b"DataArray" => self.array(tag, text),
            _ => Ok(()),
        }
    }

    fn file(&mut self, tag: &BytesStart<'_>) -> Result<(), VolumeError> {
        let get = |name: &str| Ok(attribute(tag, name)?.unwrap_or_default());
        let unsupported = |cause: String, remedy: &str| {
            Err(VolumeError::Unsupported(Trouble::new(cause, remedy)))
        };
        let kind: String = get("type")?;
        if kind == "PImageData" {
            return unsupported(
                "the file only lists other files (PImageData)".to_owned(),
                "give one of the .vti files it names, or save the image as one",
            );
        }
        if kind != "ImageData" {
            let kind: String = kind.chars().take(40).collect();
            return unsupported(
                format!("the VTK file holds {kind:?}, not ImageData"),
                "resample it to an image (ParaView: Resample To Image) and save that as .vti",
            );
        }
        self.header.version = get("version")?.chars().take(20).collect();
        let coding = &mut self.header.coding;
        coding.big_endian = match get("byte_order")?.as_str() {
            "BigEndian" => true,
            "LittleEndian" | "" => false,
            other => {
                return Err(bad(
                    format!("byte_order={other:?}"),
                    "write LittleEndian or BigEndian",
                ));
            }
        };
        coding.wide = match get("header_type")?.as_str() {
            "UInt64" => true,
            "UInt32" | "" => false,
            other => {
                return Err(bad(
                    format!("header_type={other:?}"),
                    "write UInt32 or UInt64",
                ));
            }
        };
        coding.compressor = match get("compressor")?.as_str() {
            "" => Compressor::None,
            "vtkZLibDataCompressor" => Compressor::Zlib,
            "vtkLZ4DataCompressor" => Compressor::Lz4,
            "vtkLZMADataCompressor" => Compressor::Lzma,
            other => {
                let other: String = other.chars().take(40).collect();
                return unsupported(
                    format!("the voxels are compressed by {other}"),
                    "save the file with zlib, LZ4 or LZMA",
                );
            }
        };
        Ok(())
    }

    fn data(&mut self, tag: &BytesStart<'_>, on: On) -> Result<(), VolumeError> {
        self.section = Section::On(on);
        let Some(piece) = self.header.pieces.last_mut() else {
            return Ok(());
        };
        for kind in ["Scalars", "Vectors", "Tensors"] {
            let active = &mut piece.active[usize::from(on == On::Cells)];
            if active.is_none() {
                *active = attribute(tag, kind)?;
            }
        }
        Ok(())
    }

    fn count(&mut self) -> Result<(), VolumeError> {
        self.arrays += 1;
        if self.arrays > MOST_ARRAYS {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("there are more than {MOST_ARRAYS} arrays and pieces"),
                "save the image as one piece, without the arrays that are not needed",
            )));
        }
        Ok(())
    }

    fn array(&mut self, tag: &BytesStart<'_>, (from, len): (u64, u64)) -> Result<(), VolumeError> {
        let get = |name: &str| Ok(attribute(tag, name)?.unwrap_or_default());
        let name: String = get("Name")?;
        let format: String = get("format")?;
        let ascii = format == "ascii" || format.is_empty();
        if self.section == Section::Field && name == "TimeValue" && ascii && len <= LONGEST_TIME {
            let mut text = String::new();
            // What is no text is no time; nothing depends on it.
            if self
                .input
                .open(from)?
                .take(len)
                .read_to_string(&mut text)
                .is_ok()
            {
                self.header.time = Some(text.trim().to_owned()).filter(|text| !text.is_empty());
            }
        }
        let Section::On(on) = self.section else {
            return Ok(());
        };
        let place = match format.as_str() {
            "binary" => Place::Inline { from, len },
            "appended" => {
                let [offset] = numbers(tag, "offset")?.ok_or_else(|| {
                    VolumeError::MissingField(Trouble::new(
                        format!("the array {name:?} is appended and has no offset"),
                        "write the offset of its bytes in the appended data",
                    ))
                })?;
                Place::Appended { offset }
            }
            _ if ascii => Place::Text { from, len },
            other => {
                return Err(bad(
                    format!("format={other:?}"),
                    "write ascii, binary or appended",
                ));
            }
        };
        let components = attribute(tag, "NumberOfComponents")?;
        let array = Array {
            name,
            kind: get("type")?,
            // VTK reads 0 as 1, and some writers leave it so.
            components: components
                .filter(|text| text.trim() != "0")
                .map_or_else(|| "1".to_owned(), |text| text.trim().to_owned()),
            place,
        };
        self.count()?;
        if let Some(piece) = self.header.pieces.last_mut() {
            piece.arrays.push((on, array));
        }
        Ok(())
    }

    fn finish(self) -> Result<Header, VolumeError> {
        let missing = |what: &str, remedy: &str| {
            Err(VolumeError::MissingField(Trouble::new(
                format!("the file has no {what}"),
                remedy,
            )))
        };
        if !self.image {
            return missing("element ImageData", "save it as VTK XML image data");
        }
        if self.header.pieces.is_empty() {
            return missing("element Piece", "save it with at least one piece");
        }
        Ok(self.header)
    }
}
