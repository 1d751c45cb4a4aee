//! STL by the crate `stl_io`, triangle by triangle; corners at one place become one vertex.
//!
//! Binary is what has the length that its count promises, whatever its first word. A text may hold several solids one
//! after the other, and its first line may be `solid` alone; the crate takes one solid with a name, so each is given
//! to it by itself behind a first line of our own.

use std::collections::HashMap;
use std::io::{self, Read, Seek, SeekFrom};

use glam::DVec3;
use volgraph_volume::Trouble;

use super::{MAX_LINE, Soup, excerpt, line_too_long};
use crate::MeshError;
use crate::topology::place;

const HEADER: usize = 80;
const TRIANGLE: u64 = 50;

fn binary_length(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER..HEADER + 4)?;
    let count = u32::from_le_bytes(count.try_into().ok()?);
    Some(HEADER as u64 + 4 + TRIANGLE * u64::from(count))
}

pub(crate) fn is_binary(bytes: &[u8]) -> bool {
    binary_length(bytes) == Some(bytes.len() as u64)
}

/// Whether a text begins with `solid` and goes on with a facet or the end.
pub(crate) fn is_text(bytes: &[u8]) -> bool {
    let bytes = bytes.trim_ascii_start();
    let word = |bytes: &[u8], word: &[u8]| {
        let start = bytes.get(..word.len());
        start.is_some_and(|start| start.eq_ignore_ascii_case(word))
    };
    let mut lines = bytes.split(|&byte| byte == b'\n');
    let first = lines.next().unwrap_or_default();
    let next = lines.map(<[u8]>::trim_ascii).find(|line| !line.is_empty());
    word(first, b"solid")
        && next.is_some_and(|line| word(line, b"facet") || word(line, b"endsolid"))
}

/// What to say of a file that is called STL and is neither text nor as long as its count.
pub(crate) fn wrong_length(bytes: &[u8]) -> MeshError {
    let promised = binary_length(bytes).unwrap_or_default();
    let trouble = Trouble::new(
        format!(
            "as a binary STL it would be {promised} bytes long, and it is {}",
            bytes.len()
        ),
        "fetch the file again: it is cut off, or no STL",
    );
    if promised > bytes.len() as u64 {
        MeshError::TooShort(trouble)
    } else {
        MeshError::Syntax(trouble)
    }
}

/// A first part of our own before what is left of a file; it can be set back to the start, as the crate wants.
struct Behind<'a> {
    head: &'static [u8],
    body: &'a [u8],
    at: usize,
}

impl Read for Behind<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let from = match self.head.get(self.at..) {
            Some(head) if !head.is_empty() => head,
            _ => &self.body[(self.at - self.head.len()).min(self.body.len())..],
        };
        let count = from.len().min(into.len());
        into[..count].copy_from_slice(&from[..count]);
        self.at += count;
        Ok(count)
    }
}

impl Seek for Behind<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Start(0) => {
                self.at = 0;
                Ok(0)
            }
            _ => Err(io::ErrorKind::Unsupported.into()),
        }
    }
}

/// Takes triangles, and makes one vertex of equal corners.
#[derive(Default)]
struct Welder {
    soup: Soup,
    vertices: HashMap<[u64; 3], u32>,
}

impl Welder {
    /// Reads all triangles of one solid; on an error, tells how many there were before it.
    fn read(&mut self, solid: &mut Behind<'_>) -> Result<(), (usize, io::Error)> {
        let triangles = stl_io::create_stl_reader(solid).map_err(|error| (0, error))?;
        for (count, triangle) in triangles.enumerate() {
            let triangle = triangle.map_err(|error| (count, error))?;
            let corners = triangle.vertices.map(|vertex| {
                let position = DVec3::from_array(vertex.0.map(f64::from));
                let next = self.soup.positions.len() as u32;
                let vertex = *self.vertices.entry(place(position)).or_insert(next);
                if vertex == next {
                    self.soup.positions.push(position);
                }
                vertex
            });
            self.soup.triangles.push(corners);
        }
        Ok(())
    }
}

pub(crate) fn parse_binary(bytes: &[u8]) -> Result<Soup, MeshError> {
    let mut welder = Welder::default();
    let mut solid = Behind {
        // Whatever the header says, it does not say `solid`.
        head: &[0; HEADER],
        body: &bytes[HEADER.min(bytes.len())..],
        at: 0,
    };
    welder.read(&mut solid).map_err(|(count, error)| {
        MeshError::TooShort(Trouble::new(
            format!("triangle {count} (from 0) cannot be read: {error}"),
            "the file is cut off: fetch it again",
        ))
    })?;
    welder.soup.format = "STL binary".into();
    Ok(welder.soup)
}

pub(crate) fn parse_text(bytes: &[u8]) -> Result<Soup, MeshError> {
    let mut welder = Welder::default();
    // The body of the solid that is read: its first line's number and where it starts.
    let mut body: Option<(usize, usize)> = None;
    let mut at = 0;
    for (number, line) in (1..).zip(bytes.split_inclusive(|&byte| byte == b'\n')) {
        at += line.len();
        if line.len() > MAX_LINE {
            return Err(line_too_long().on_line(number));
        }
        let mut words = line
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty());
        let first = words.next().unwrap_or_default();
        if let Some((body_line, start)) = body {
            if first.eq_ignore_ascii_case(b"endsolid") {
                read_solid(&mut welder, &bytes[start..at], body_line)?;
                body = None;
            }
        } else if first.eq_ignore_ascii_case(b"solid") {
            body = Some((number + 1, at));
        } else if !first.is_empty() {
            return Err(MeshError::Syntax(Trouble::new(
                format!(
                    "{} stands outside of a solid",
                    excerpt(&String::from_utf8_lossy(line))
                ),
                "put facets between solid and endsolid",
            ))
            .on_line(number));
        }
    }
    if let Some((line, start)) = body {
        read_solid(&mut welder, &bytes[start..], line)?;
    }
    welder.soup.format = "STL ascii".into();
    Ok(welder.soup)
}

fn read_solid(welder: &mut Welder, body: &[u8], first_line: usize) -> Result<(), MeshError> {
    let mut solid = Behind {
        head: b"solid \n",
        body,
        at: 0,
    };
    let Err((count, error)) = welder.read(&mut solid) else {
        return Ok(());
    };
    // Each good facet before it took seven lines with something on them.
    let mut filled = (first_line..)
        .zip(body.split(|&byte| byte == b'\n'))
        .filter(|(_, line)| !line.trim_ascii().is_empty());
    let line = filled.nth(count * 7).map(|(line, _)| line);
    let trouble = Trouble::new(
        format!(
            "the facet that begins here cannot be read: {}",
            excerpt(&error.to_string())
        ),
        "write the file again, each facet with a normal and three vertices of finite numbers, and endsolid at the end",
    );
    let error = match error.kind() {
        io::ErrorKind::UnexpectedEof => MeshError::TooShort(trouble),
        _ => MeshError::Syntax(trouble),
    };
    Err(error.on_line(line.unwrap_or(first_line)))
}
