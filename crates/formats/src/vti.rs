//! VTI, the ImageData of VTK's XML files, serial. Source: "VTK File Formats" and vtkXMLImageDataReader.
//!
//! `scan` takes the elements of the file as they pass, with the places of the voxels: the text of each array is
//! passed over, and behind `_` of the appended data nothing is parsed, for it need not be XML. The option `part`
//! picks one array of points or cells; `blocks` decodes its bytes (text, base64, raw; zlib, LZ4, LZMA) as a stream; `pieces`
//! puts the pieces of the extent together. Values at points lie at the points, values of cells in the middle between
//! them. VTK does not say what its axes mean: world coordinates are taken as they are, as LPS.
//!
//! The crate `vtkio` is not fit for it: it allocates what the file says, does not know `Direction`, and brings a
//! library of the system for xz. XML, base64 and the compressors have crates that are.

mod blocks;
mod header;
mod letters;
mod pieces;
mod scan;

use glam::{DAffine3, DMat3, DVec3};
use volgraph_volume::{Grid, ScalarType, Trouble, Values, VolumeError};

use crate::axes::Axes;
use crate::contents::{Components, Contents, Opened};
use crate::input::{Input, stem};
use crate::load::LoadOptions;
use header::{Array, Header, On};
use pieces::{Pieces, Span};

/// Whether a file with this head is a VTK XML file; of what is said by [`open`].
pub(crate) fn is_vti(head: &[u8]) -> bool {
    let text = head
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(head)
        .trim_ascii_start();
    let xml =
        text.starts_with(b"<?xml") || text.starts_with(b"<!--") || text.starts_with(b"<VTKFile");
    xml && text.windows(8).any(|window| window == b"<VTKFile")
}

/// Opens a file of image data.
pub(crate) fn open<'a>(
    input: &Input<'a>,
    options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let header = scan::read(input)?;
    let (on, name) = choose(&header, options)?;
    let first = header
        .array(0, on, &name)
        .ok_or_else(|| missing(&name, 0))?;
    let (scalar_type, components) = (first.scalar_type()?, first.components()?);
    let dims = on.dims(header.extent)?;
    let spans = spans(&header, on, &name, scalar_type, components)?;
    let mut sizes: Vec<u64> = dims.iter().map(|&size| size.into()).collect();
    let first_axis = usize::from(components > 1);
    if components > 1 {
        sizes.insert(0, components);
    }
    let axes = Axes::new(sizes, (first_axis..first_axis + 3).collect())?;
    let count = axes.count()?;
    let version = if header.version.is_empty() {
        "VTI".to_owned()
    } else {
        format!("VTI {}", header.version)
    };
    let mut contents = Contents::new(
        version,
        stem(&input.path),
        axes.clone(),
        scalar_type,
        grid(&header, on, dims),
    );
    // VTK itself takes bytes of two to four as colours.
    if scalar_type == ScalarType::U8 && (2..=4).contains(&components) {
        contents.components = Components::Colors;
    }
    if !name.is_empty() {
        contents.about.values = Values::Named(name.clone());
    }
    let all: Vec<String> = header.names().map(|(_, name)| name.to_owned()).collect();
    if all.len() > 1 {
        contents
            .about
            .facts
            .push(("arrays".to_owned(), all.join(", ")));
    }
    if on == On::Cells {
        contents
            .about
            .facts
            .push(("values on".to_owned(), "cells".to_owned()));
    }
    if let Some(time) = &header.time {
        contents.about.facts.push(("time".to_owned(), time.clone()));
    }
    contents.warnings = header.warnings;
    let data = Pieces {
        input: input.clone(),
        coding: header.coding,
        spans,
        scalar_type,
        components,
        dims,
        count,
        what: axes.describe(scalar_type),
    };
    Ok(Opened {
        contents,
        data: Box::new(data),
    })
}

fn missing(name: &str, piece: usize) -> VolumeError {
    VolumeError::MissingField(Trouble::new(
        format!("piece {} has no array {name:?}", piece + 1),
        "write the same arrays for each piece",
    ))
}

/// The array that the options name; else the only one, or the one that the file calls active, points before cells.
fn choose(header: &Header, options: &LoadOptions) -> Result<(On, String), VolumeError> {
    let all: Vec<(On, &str)> = header.names().collect();
    let list = || {
        all.iter()
            .map(|(_, name)| *name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    let refuse =
        |cause: String, remedy: String| Err(VolumeError::Option(Trouble::new(cause, remedy)));
    let picked = |(on, name): (On, &str)| Ok((on, name.to_owned()));
    if all.is_empty() {
        return Err(VolumeError::MissingField(Trouble::new(
            "there is no array of points or cells",
            "save the file with point data or cell data",
        )));
    }
    if let Some(part) = &options.part {
        if let Some(&exact) = all.iter().find(|(_, name)| name == part) {
            return picked(exact);
        }
        let lower = part.to_lowercase();
        let having = all
            .iter()
            .filter(|(_, name)| name.to_lowercase().contains(&lower));
        return match having.copied().collect::<Vec<_>>().as_slice() {
            &[one] => picked(one),
            [] => refuse(
                format!("there is no array {part:?}"),
                format!("name one of {}", list()),
            ),
            several => {
                let names: Vec<&str> = several.iter().map(|(_, name)| *name).collect();
                refuse(
                    format!("{part:?} is part of several names: {}", names.join(", ")),
                    "name one of them in full".to_owned(),
                )
            }
        };
    }
    let active = [On::Points, On::Cells].into_iter().find_map(|on| {
        let name = header.active(on)?;
        all.iter().find(|one| **one == (on, name)).copied()
    });
    match (all.as_slice(), active) {
        (&[one], _) | (_, Some(one)) => picked(one),
        _ => refuse(
            format!("there are {} arrays: {}", all.len(), list()),
            "name one with the option `part`".to_owned(),
        ),
    }
}

/// The array of each piece, and where it lies in the whole.
fn spans(
    header: &Header,
    on: On,
    name: &str,
    scalar_type: ScalarType,
    components: u64,
) -> Result<Vec<Span>, VolumeError> {
    let mut spans = Vec::new();
    for (index, piece) in header.pieces.iter().enumerate() {
        let inside = piece
            .extent
            .iter()
            .zip(header.extent)
            .all(|(part, whole)| part[0] >= whole[0] && part[1] <= whole[1]);
        if !inside {
            return Err(VolumeError::BadValue(Trouble::new(
                format!(
                    "piece {} has the extent {:?}, outside of {:?}",
                    index + 1,
                    piece.extent,
                    header.extent
                ),
                "correct Extent or WholeExtent",
            )));
        }
        let array: &Array = header
            .array(index, on, name)
            .ok_or_else(|| missing(name, index))?;
        if array.scalar_type()? != scalar_type || array.components()? != components {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!(
                    "array {name:?} has another type or number of components in piece {}",
                    index + 1
                ),
                "write the same type for each piece",
            )));
        }
        let flat = |[from, to]: [i32; 2]| from == to;
        let slab = (0..3).any(|axis| flat(piece.extent[axis]) && !flat(header.extent[axis]));
        // A layer of points between two others has no cells.
        if on == On::Cells && slab {
            continue;
        }
        let dims = on.dims(piece.extent)?;
        let from = [0, 1, 2].map(|axis| piece.extent[axis][0].abs_diff(header.extent[axis][0]));
        spans.push(Span {
            from,
            dims,
            place: array.place.clone(),
        });
    }
    Ok(spans)
}

/// Point (0, 0, 0) is at the origin, whatever the extent begins with.
fn grid(header: &Header, on: On, dims: [u32; 3]) -> Grid {
    let matrix3 = header.direction * DMat3::from_diagonal(header.spacing);
    let start = header.extent.map(|[from, _]| f64::from(from));
    let mut first = DVec3::from_array(start);
    if on == On::Cells {
        let flat = header
            .extent
            .map(|[from, to]| if from == to { 0.0 } else { 0.5 });
        first += DVec3::from_array(flat);
    }
    Grid {
        dims,
        world_from_index: DAffine3 {
            matrix3,
            translation: header.origin + matrix3 * first,
        },
        // An image's bounds go from its first to its last point.
        node_centred: on == On::Points,
    }
}
