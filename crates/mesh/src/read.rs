//! Meshes in files: PLY, OBJ, STL, plain or in gzip.
//!
//! The whole content is taken into memory, growing as the stream delivers, up to a limit; its length is then what
//! every count in it is held against. The content tells the format (`ply`, or the length that a binary STL promises, or
//! a facet of a text STL); OBJ has no mark of its own and is told by its name or its first lines.

mod obj;
mod ply;
mod stl;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use glam::DVec3;
use volgraph_volume::Trouble;

use crate::{Mesh, MeshError};

/// The limit on a file's decoded content where nobody names another: 4 GiB.
const DEFAULT_MAX_BYTES: u64 = 4 << 30;

/// What the user says about a mesh file beside its path.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Most bytes of the file's content, after gzip; 4 GiB where `None`.
    pub max_bytes: Option<u64>,
}

/// What a reader found: not yet checked, but for the lines of its format.
#[derive(Debug, Default)]
pub(crate) struct Soup {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub format: String,
    pub warnings: Vec<String>,
}

impl Soup {
    /// Cuts a polygon into a fan of triangles about its first corner. Corners are numbered as the vertices will be.
    pub fn push_polygon(&mut self, corners: &[u32]) {
        if let [first, rest @ ..] = corners {
            let fan = rest.windows(2).map(|pair| [*first, pair[0], pair[1]]);
            self.triangles.extend(fan);
        }
    }
}

pub(crate) fn read(path: &Path, options: &ReadOptions) -> Result<Mesh, MeshError> {
    let open = || -> Result<File, String> {
        let metadata =
            std::fs::metadata(path).map_err(|error| format!("cannot be read: {error}"))?;
        if metadata.is_dir() {
            return Err("is a folder, not a file".into());
        }
        if !metadata.is_file() {
            return Err("is no regular file".into());
        }
        File::open(path).map_err(|error| format!("cannot be read: {error}"))
    };
    let file = open().map_err(|cause| {
        let remedy = "give the path of a mesh file that can be read";
        MeshError::Unreadable(Trouble::new(cause, remedy)).in_file(path)
    })?;
    take(file, options)
        .and_then(|bytes| parse(path, bytes, options))
        .map_err(|error| error.in_file(path))
}

pub(crate) fn from_bytes(
    path: &Path,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Mesh, MeshError> {
    take(bytes, options)
        .and_then(|bytes| parse(path, bytes, options))
        .map_err(|error| error.in_file(path))
}

/// Everything that a stream holds, up to the limit.
fn take(stream: impl Read, options: &ReadOptions) -> Result<Vec<u8>, MeshError> {
    let limit = options.max_bytes.unwrap_or(DEFAULT_MAX_BYTES);
    let mut bytes = Vec::new();
    stream
        .take(limit.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|error| match error.kind() {
            io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => {
                MeshError::Syntax(Trouble::new(
                    format!("the gzip stream cannot be decoded: {error}"),
                    "fetch the file again",
                ))
            }
            io::ErrorKind::UnexpectedEof => MeshError::TooShort(Trouble::new(
                "the gzip stream is cut off",
                "fetch the file again",
            )),
            io::ErrorKind::OutOfMemory => MeshError::TooLarge(Trouble::new(
                "memory does not hold the file's content",
                "free memory, or simplify the mesh",
            )),
            _ => MeshError::Unreadable(Trouble::new(
                format!("cannot be read: {error}"),
                "check the file, its permissions and the disk",
            )),
        })?;
    if bytes.len() as u64 > limit {
        return Err(MeshError::TooLarge(Trouble::new(
            format!("holds more than the limit of {limit} bytes"),
            "simplify the mesh, or raise the limit (max_bytes)",
        )));
    }
    Ok(bytes)
}

fn parse(path: &Path, bytes: Vec<u8>, options: &ReadOptions) -> Result<Mesh, MeshError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut lower = name.to_ascii_lowercase();
    let bytes = if bytes.starts_with(b"\x1f\x8b") {
        lower = lower.trim_end_matches(".gz").to_owned();
        take(MultiGzDecoder::new(bytes.as_slice()), options)?
    } else {
        bytes
    };
    let soup = if ply::is_ply(&bytes) {
        ply::parse(&bytes)
    } else if stl::is_binary(&bytes) {
        stl::parse_binary(&bytes)
    } else if stl::is_text(&bytes) {
        stl::parse_text(&bytes)
    } else if lower.ends_with(".obj") || obj::looks_like_obj(&bytes) {
        obj::parse(&bytes)
    } else {
        Err(unknown(&lower, &bytes))
    }?;
    let stem = name.split('.').find(|part| !part.is_empty());
    let mesh = Mesh::new(stem.unwrap_or("mesh"), soup.positions, soup.triangles)?;
    Ok(mesh.with_source(soup.format, path, soup.warnings))
}

fn unknown(name: &str, bytes: &[u8]) -> MeshError {
    if name.ends_with(".stl") && bytes.len() >= 84 {
        return stl::wrong_length(bytes);
    }
    let cause = if bytes.is_empty() {
        "is empty".to_owned()
    } else {
        match [".ply", ".stl"].iter().find(|end| name.ends_with(**end)) {
            Some(end) => format!("the name says {end}, the content is none"),
            None => "is no mesh format that is read here".to_owned(),
        }
    };
    MeshError::UnknownFormat(Trouble::new(
        cause,
        "fetch the file again, or convert it to PLY, OBJ or STL",
    ))
}

/// The longest line of a text that is taken apart: a polygon of a hundred thousand corners fits. Words cost a
/// multiple of their bytes, so a file of one endless line is refused instead.
pub(crate) const MAX_LINE: usize = 1 << 20;

pub(crate) fn line_too_long() -> MeshError {
    MeshError::Unsupported(Trouble::new(
        format!("the line is longer than {MAX_LINE} bytes"),
        "write each vertex and each face on a line of its own",
    ))
}

/// A part of a file for a message: short, and of printable characters.
pub(crate) fn excerpt(text: &str) -> String {
    let first: String = text.trim().chars().take(80).collect();
    format!("{first:?}")
}
