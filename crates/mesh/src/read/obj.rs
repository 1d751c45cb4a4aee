//! Wavefront OBJ: `v` and `f` lines, of all objects and groups together.
//!
//! Written by hand: the crates for it read float32, tell no line of an error, repeat the vertices that objects share,
//! or overflow on forged indices of texture coordinates, which do not matter here. Lines that end in a backslash go
//! on; indices count from 1, negative ones back from the last vertex; what follows a slash is left alone.

use glam::DVec3;
use volgraph_volume::Trouble;

use super::{Soup, excerpt};
use crate::MeshError;

/// Whether the first lines look like OBJ: nothing but its keywords.
pub(crate) fn looks_like_obj(bytes: &[u8]) -> bool {
    const KEYWORDS: [&str; 11] = [
        "v", "vt", "vn", "vp", "f", "o", "g", "s", "mtllib", "usemtl", "l",
    ];
    let head = &bytes[..bytes.len().min(4096)];
    let head = match head.iter().rposition(|&byte| byte == b'\n') {
        Some(end) => &head[..end],
        None => head,
    };
    let Ok(text) = std::str::from_utf8(head) else {
        return false;
    };
    let mut goes_on = false;
    let mut words = text
        .lines()
        .filter(|line| !std::mem::replace(&mut goes_on, line.trim_end().ends_with('\\')))
        .filter_map(|line| line.split_ascii_whitespace().next())
        .filter(|word| !word.starts_with('#'))
        .peekable();
    words.peek().is_some() && words.all(|word| KEYWORDS.contains(&word))
}

pub(crate) fn parse(bytes: &[u8]) -> Result<Soup, MeshError> {
    let mut soup = Soup {
        format: "OBJ".into(),
        ..Soup::default()
    };
    // The highest vertex that a face names, and the face's line: vertices may come behind their faces.
    let mut highest = (0, 0);
    let mut polygon = Vec::new();
    let mut joined = Vec::new();
    let mut lines = (1..).zip(bytes.split(|&byte| byte == b'\n'));
    while let Some((number, mut line)) = lines.next() {
        if line.trim_ascii_end().ends_with(b"\\") {
            joined.clear();
            while let Some(start) = line.trim_ascii_end().strip_suffix(b"\\") {
                joined.extend_from_slice(start);
                joined.push(b' ');
                line = lines.next().map_or(&[][..], |(_, line)| line);
            }
            joined.extend_from_slice(line);
            line = &joined;
        }
        let mut line = line.trim_ascii();
        if let Some(comment) = line.iter().position(|&byte| byte == b'#') {
            line = &line[..comment];
        }
        let keyword = line.split(u8::is_ascii_whitespace).next();
        let parsed = match keyword {
            Some(b"v") => vertex(line).map(|position| soup.positions.push(position)),
            Some(b"f") => face(line, soup.positions.len(), &mut polygon).map(|()| {
                let last = polygon.iter().copied().max().unwrap_or_default();
                if last >= highest.0 {
                    highest = (last, number);
                }
                soup.push_polygon(&polygon);
            }),
            _ => Ok(()),
        };
        parsed.map_err(|error| error.on_line(number))?;
    }
    if !soup.triangles.is_empty() && highest.0 as usize >= soup.positions.len() {
        return Err(MeshError::Index(Trouble::new(
            format!(
                "a face names vertex {}, and there are {}",
                highest.0 + 1,
                soup.positions.len()
            ),
            "the file is cut off or broken: write it again",
        ))
        .on_line(highest.1));
    }
    Ok(soup)
}

fn words(line: &[u8]) -> Result<impl Iterator<Item = &str>, MeshError> {
    match std::str::from_utf8(line) {
        Ok(line) => Ok(line.split_ascii_whitespace().skip(1)),
        Err(_) => Err(MeshError::Syntax(Trouble::new(
            "the line is not text",
            "write vertices and faces as numbers in ASCII",
        ))),
    }
}

fn vertex(line: &[u8]) -> Result<DVec3, MeshError> {
    let mut words = words(line)?;
    let mut position = [0.0; 3];
    for (axis, number) in ["x", "y", "z"].iter().zip(&mut position) {
        let Some(word) = words.next() else {
            return Err(MeshError::Syntax(Trouble::new(
                format!("the vertex has no {axis}"),
                "give each vertex three coordinates",
            )));
        };
        *number = word.parse().map_err(|_| {
            MeshError::BadValue(Trouble::new(
                format!("{} is no number", excerpt(word)),
                "write coordinates as decimal numbers",
            ))
        })?;
    }
    let position = DVec3::from_array(position);
    if !position.is_finite() {
        return Err(MeshError::BadValue(Trouble::new(
            format!("the vertex lies at {position}"),
            "give finite coordinates",
        )));
    }
    Ok(position)
}

/// The corners of a face; `count` vertices were read before it.
fn face(line: &[u8], count: usize, polygon: &mut Vec<u32>) -> Result<(), MeshError> {
    polygon.clear();
    for word in words(line)? {
        let vertex = word.split('/').next().unwrap_or_default();
        let index: i64 = vertex.parse().map_err(|_| {
            MeshError::BadValue(Trouble::new(
                format!("{} names no vertex", excerpt(word)),
                "name corners as v, v/vt, v//vn or v/vt/vn",
            ))
        })?;
        let from_zero = match index {
            1.. => Some(index - 1),
            0 => None,
            _ => Some(count as i64 + index),
        };
        let corner = from_zero.and_then(|index| u32::try_from(index).ok());
        let corner = corner.filter(|&corner| corner < u32::MAX);
        polygon.push(corner.ok_or_else(|| {
            MeshError::Index(Trouble::new(
                format!("vertex {index} does not exist ({count} were read so far)"),
                "count vertices from 1, or back from -1",
            ))
        })?);
    }
    if polygon.len() < 3 {
        return Err(MeshError::Syntax(Trouble::new(
            format!("the face has {} corners", polygon.len()),
            "give each face three corners or more",
        )));
    }
    Ok(())
}
