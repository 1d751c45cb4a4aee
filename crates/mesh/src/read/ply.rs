//! PLY by the crate `ply-rs-bw`, element by element, so that no more is kept than positions and faces.
//!
//! Its header is parsed as a whole; then each element's count is held against the bytes that are left, as every
//! element has at least one. Elements and properties that are neither corners nor faces are read over.

use std::io::{BufRead, Read};

use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use volgraph_volume::Trouble;

use super::{MAX_LINE, Soup, excerpt, line_too_long};
use crate::MeshError;

pub(crate) fn is_ply(bytes: &[u8]) -> bool {
    matches!(bytes, [b'p', b'l', b'y', b'\n' | b'\r' | b' ', ..])
}

/// What is kept of an element.
#[derive(Default)]
struct Element {
    position: [f64; 3],
    /// Corners of a face, where there are any; -1 for what is no index.
    corners: Option<Vec<i64>>,
    strip: bool,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match name {
            "x" | "y" | "z" => {
                let axis = (name.as_bytes()[0] - b'x') as usize;
                // What is no number is not finite, and refused as such.
                self.position[axis] = number(&property).unwrap_or(f64::NAN);
            }
            "vertex_indices" | "vertex_index" => {
                self.corners = list(property);
                self.strip = self.corners.is_none();
            }
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

fn number(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(value) => value.into(),
        Property::UChar(value) => value.into(),
        Property::Short(value) => value.into(),
        Property::UShort(value) => value.into(),
        Property::Int(value) => value.into(),
        Property::UInt(value) => value.into(),
        Property::Float(value) => value.into(),
        Property::Double(value) => value,
        _ => return None,
    })
}

fn list(property: Property) -> Option<Vec<i64>> {
    fn wide<T: Into<i64>>(values: Vec<T>) -> Vec<i64> {
        values.into_iter().map(Into::into).collect()
    }
    Some(match property {
        Property::ListChar(values) => wide(values),
        Property::ListUChar(values) => wide(values),
        Property::ListShort(values) => wide(values),
        Property::ListUShort(values) => wide(values),
        Property::ListInt(values) => wide(values),
        Property::ListUInt(values) => wide(values),
        _ => return None,
    })
}

/// The fewest bytes that an element takes.
fn least_bytes(element: &ElementDef, encoding: Encoding) -> u64 {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let properties = element.properties.values();
    match encoding {
        // A digit and a space or the end of the line.
        Encoding::Ascii => properties.len() as u64 * 2,
        _ => properties
            .map(|property| match &property.data_type {
                PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
            })
            .sum(),
    }
}

pub(crate) fn parse(bytes: &[u8]) -> Result<Soup, MeshError> {
    let mut reader = Reader::new(bytes);
    let parser = Parser::<Element>::new();
    let header = parser.read_header(&mut reader).map_err(|error| {
        let line = error.line().unwrap_or_default();
        MeshError::Syntax(Trouble::new(
            format!("the header is not PLY: {}", first_line(&error)),
            "write the file again, or correct its header",
        ))
        .on_line(line)
    })?;
    let encoding = header.encoding;
    let mut soup = Soup {
        format: match encoding {
            Encoding::Ascii => "PLY ascii".into(),
            _ => "PLY binary".into(),
        },
        ..Soup::default()
    };
    check_elements(header.elements.values())?;
    // The last line of the header; the parser stands behind it.
    let mut line = reader.line().saturating_sub(1);
    let mut rest = reader.into_inner();
    for element in header.elements.values() {
        let needs = least_bytes(element, encoding).saturating_mul(element.count as u64);
        // The last line of a text may lack its end.
        if needs > rest.len() as u64 + 1 {
            return Err(MeshError::TooShort(Trouble::new(
                format!(
                    "{} elements {:?} need {needs} bytes or more, and {} are left",
                    element.count,
                    element.name,
                    rest.len()
                ),
                "the file is cut off: fetch it again, or correct the count",
            )));
        }
        if element.properties.is_empty() {
            continue;
        }
        for _ in 0..element.count {
            let read = next(&parser, &mut rest, element, encoding, &mut line)
                .and_then(|read| keep(&mut soup, element, read));
            if let Err(error) = read {
                return Err(match encoding {
                    Encoding::Ascii => error.on_line(line),
                    _ => error,
                });
            }
        }
    }
    let count = soup.positions.len();
    let wrong = |corners: &&[u32; 3]| corners.iter().any(|&corner| corner as usize >= count);
    if let Some(corners) = soup.triangles.iter().find(wrong) {
        return Err(MeshError::Index(Trouble::new(
            format!("a face names the vertices {corners:?} (from 0), and there are {count}"),
            "the file is broken: write it again",
        )));
    }
    Ok(soup)
}

fn check_elements<'a>(elements: impl Iterator<Item = &'a ElementDef>) -> Result<(), MeshError> {
    let (mut vertices, mut faces, mut strips) = (false, false, false);
    for element in elements {
        let has = |name: &str| element.properties.contains_key(name);
        match element.name.as_str() {
            "vertex" => vertices = ["x", "y", "z"].into_iter().all(has),
            "face" => faces = has("vertex_indices") || has("vertex_index"),
            "tristrips" => strips = true,
            _ => {}
        }
    }
    if !vertices {
        return Err(MeshError::Syntax(Trouble::new(
            "the header has no element vertex with the properties x, y and z",
            "write the file with vertices",
        )));
    }
    if !faces && strips {
        return Err(MeshError::Unsupported(Trouble::new(
            "the faces are stored as strips (tristrips)",
            "convert the file to one with the element face",
        )));
    }
    if !faces {
        return Err(MeshError::Empty(Trouble::new(
            "the header has no element face with a list vertex_indices",
            "give a mesh with faces; point clouds have no inside",
        )));
    }
    Ok(())
}

/// Reads one element; `line` ends on its line.
fn next(
    parser: &Parser<Element>,
    rest: &mut &[u8],
    element: &ElementDef,
    encoding: Encoding,
    line: &mut usize,
) -> Result<Element, MeshError> {
    let read = match encoding {
        Encoding::BinaryLittleEndian => parser.read_little_endian_element(rest, element),
        Encoding::BinaryBigEndian => parser.read_big_endian_element(rest, element),
        Encoding::Ascii => {
            let mut text = String::new();
            // Empty lines between elements are no elements.
            while text.trim_ascii().is_empty() {
                text.clear();
                *line += 1;
                match rest.by_ref().take(MAX_LINE as u64).read_line(&mut text) {
                    Ok(0) => return Err(cut_off(element)),
                    Ok(MAX_LINE) => return Err(line_too_long()),
                    Ok(_) => {}
                    Err(_) => {
                        return Err(MeshError::Syntax(Trouble::new(
                            "the line is not text",
                            "write the file again, as ascii or binary as its header says",
                        )));
                    }
                }
            }
            parser.read_ascii_element(&text, element)
        }
    };
    read.map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => cut_off(element),
        _ if encoding != Encoding::Ascii && rest.is_empty() => cut_off(element),
        _ => MeshError::BadValue(Trouble::new(
            format!(
                "an element {:?} cannot be read: {}",
                element.name,
                first_line(&error)
            ),
            "write the file again, with numbers of the types that the header says",
        )),
    })
}

fn cut_off(element: &ElementDef) -> MeshError {
    MeshError::TooShort(Trouble::new(
        format!(
            "ends before all {} elements {:?}",
            element.count, element.name
        ),
        "the file is cut off: fetch it again, or correct the count",
    ))
}

fn keep(soup: &mut Soup, element: &ElementDef, read: Element) -> Result<(), MeshError> {
    match element.name.as_str() {
        "vertex" => {
            let position = DVec3::from_array(read.position);
            if !position.is_finite() {
                return Err(MeshError::BadValue(Trouble::new(
                    format!(
                        "vertex {} (from 0) lies at {position}",
                        soup.positions.len()
                    ),
                    "give every vertex three finite coordinates",
                )));
            }
            soup.positions.push(position);
        }
        "face" => {
            let corners = read.corners.unwrap_or_default();
            let valid: Option<Vec<u32>> = corners
                .iter()
                .map(|&corner| u32::try_from(corner).ok())
                .collect();
            let (Some(corners), false) = (valid, read.strip) else {
                return Err(MeshError::Index(Trouble::new(
                    format!("a face has the corners {corners:?}"),
                    "name vertices by whole numbers from 0",
                )));
            };
            soup.push_polygon(&corners);
        }
        _ => {}
    }
    Ok(())
}

/// The crate's messages go over several lines; the first one says what is wrong.
fn first_line(error: &ParseError) -> String {
    let text = error.to_string();
    let text = match error.line() {
        Some(line) => text
            .strip_prefix(&format!("Line {line}: "))
            .unwrap_or(&text),
        None => &text,
    };
    excerpt(text.lines().next().unwrap_or_default())
        .trim_matches('"')
        .trim_end_matches(['.', ','])
        .to_owned()
}
