//! NRRD, the "nearly raw raster data" of the Teem library, versions 1 to 6, attached and detached.
//! Source: <https://teem.sourceforge.net/nrrd/format.html>.
//!
//! [`parse_header`] turns the lines into fields, each once, and the fields into a [`Header`] of plain values;
//! `placement` makes the grid in LPS of them; `load` then reads the data. Axes that are not spatial (by
//! `kinds`, or `none` in `space directions`) are time (kind `time`) or hold components. Of the `key:=value` pairs
//! those are read by which 3D Slicer names the segments of a label map; comments mean nothing. What the format leaves
//! open, a warning tells.

mod placement;

use std::collections::BTreeMap;

use volgraph_volume::{ScalarType, Trouble, Values, VolumeError};

use crate::axes::Axes;
use crate::contents::{Components, Contents, Opened};
use crate::data_files::DataFiles;
use crate::fields::{
    Field, Fields, LONGEST_HEADER, endless_header, lines, text_line, warn_unknown,
};
use crate::input::Input;
use crate::load::LoadOptions;
use crate::piece::{Encoding, Piece};
use crate::raw::unknown_type;
use crate::stream::{Job, Stored};

/// Fields that the format has and that say nothing about where or what the voxels are.
const IGNORED: [&str; 11] = [
    "block size",
    "content",
    "labels",
    "max",
    "measurement frame",
    "min",
    "number",
    "old max",
    "old min",
    "sample units",
    "units",
];

/// Most segments that are named in a header.
const MOST_SEGMENTS: usize = 65_536;

/// Fields that are read.
const READ: [&str; 19] = [
    "axis maxs",
    "axis mins",
    "byte skip",
    "centerings",
    "data file",
    "dimension",
    "encoding",
    "endian",
    "kinds",
    "line skip",
    "sizes",
    "space",
    "space dimension",
    "space directions",
    "space origin",
    "space units",
    "spacings",
    "thicknesses",
    "type",
];

/// A header, its values checked one by one but not yet against each other or the data.
#[derive(Debug)]
pub struct Header {
    /// 1 to 6.
    pub version: u8,
    /// Type of the elements.
    pub scalar_type: ScalarType,
    /// Sizes of all axes, fastest first.
    pub sizes: Vec<u64>,
    /// How the elements are written down.
    pub encoding: Encoding,
    /// Byte order, where it is said.
    pub big_endian: Option<bool>,
    /// Lines to pass over before the data, before decoding.
    pub line_skip: u64,
    /// Bytes to pass over then, after decoding; negative ones count from the end.
    pub byte_skip: i64,
    /// Where the data is.
    pub data_files: DataFiles,
    /// Offset behind the header in its own file.
    pub data_offset: u64,
    /// What the user should know.
    pub warnings: Vec<String>,
    fields: Fields,
    /// Segments by their number in the file: label value and name, as 3D Slicer writes them.
    segments: BTreeMap<u32, Segment>,
}

/// What a file says of a segment of its label map.
#[derive(Debug, Default)]
struct Segment {
    label: Option<i64>,
    name: Option<String>,
}

/// Whether a file with this head is NRRD.
pub(crate) fn is_nrrd(head: &[u8]) -> bool {
    head.starts_with(b"NRRD00")
}

/// Reads the header at the beginning of `bytes`; what follows it is not looked at.
///
/// # Errors
/// A [`VolumeError`] without a file, with the line where there is one.
pub fn parse_header(bytes: &[u8]) -> Result<Header, VolumeError> {
    let mut all = lines(bytes);
    let magic = all.next().map_or(&b""[..], |(line, ..)| line);
    let version = match magic.strip_prefix(b"NRRD000") {
        Some(&[digit @ b'1'..=b'6']) => digit - b'0',
        _ => {
            return Err(VolumeError::Unsupported(Trouble::new(
                "the first line is none of NRRD0001 to NRRD0006",
                "save the file as NRRD0004 or NRRD0005",
            ))
            .on_line(1));
        }
    };
    let mut fields = Fields::default();
    let mut warnings = Vec::new();
    let mut listed = Vec::new();
    let mut in_list = false;
    let mut segments = BTreeMap::new();
    let mut data_offset = bytes.len() as u64;
    for (number, (line, after, _)) in (2_u32..).zip(all) {
        if line.is_empty() {
            data_offset = after as u64;
            break;
        }
        if in_list {
            listed.push(text_line(line, number)?.trim().to_owned());
            continue;
        }
        let Some(field) = parse_line(line, number)? else {
            note_segment(line, &mut segments);
            continue;
        };
        let key = field.key.as_str();
        if READ.contains(&key) {
            in_list = key == "data file" && is_list(&field.value);
            fields.push(field)?;
        } else if !IGNORED.contains(&key) {
            warn_unknown(&mut warnings, &field, &READ, false);
        }
    }
    let mut header = Header::of(version, fields, listed, data_offset, warnings)?;
    header.segments = segments;
    Ok(header)
}

/// Takes `Segment3_Name:=liver` and `Segment3_LabelValue:=4` down; other pairs mean nothing here.
fn note_segment(line: &[u8], segments: &mut BTreeMap<u32, Segment>) {
    let Ok(line) = std::str::from_utf8(line) else {
        return;
    };
    let parsed = || {
        let (key, value) = line.strip_prefix("Segment")?.split_once(":=")?;
        let (number, what) = key.split_once('_')?;
        Some((number.parse().ok()?, what, value.trim()))
    };
    let Some((number, what, value)) = parsed() else {
        return;
    };
    if !matches!(what, "LabelValue" | "Name") || segments.len() >= MOST_SEGMENTS {
        return;
    }
    let segment: &mut Segment = segments.entry(number).or_default();
    match what {
        "LabelValue" => segment.label = value.parse().ok(),
        _ => segment.name = Some(value.to_owned()),
    }
}

fn is_list(value: &str) -> bool {
    value
        .split_whitespace()
        .next()
        .is_some_and(|word| word.eq_ignore_ascii_case("list"))
}

/// The field of a line; `None` for comments and `key:=value` pairs, which may hold any bytes.
fn parse_line(line: &[u8], number: u32) -> Result<Option<Field>, VolumeError> {
    let colon = line.iter().position(|&byte| byte == b':');
    if line.starts_with(b"#") || colon.is_some_and(|at| line.get(at + 1) == Some(&b'=')) {
        return Ok(None);
    }
    let colon = colon.ok_or_else(|| {
        let start: String = String::from_utf8_lossy(line).chars().take(40).collect();
        VolumeError::HeaderSyntax(Trouble::new(
            format!("the line {start:?} is no field"),
            "write `field: value`, `key:=value` or `# comment`, and end the header with an empty line",
        ))
        .on_line(number)
    })?;
    let key = canonical(text_line(&line[..colon], number)?);
    let value = if IGNORED.contains(&key.as_str()) {
        String::new()
    } else {
        text_line(&line[colon + 1..], number)?.trim().to_owned()
    };
    Ok(Some(Field {
        key,
        value,
        line: number,
    }))
}

/// The one spelling of a field's name.
fn canonical(key: &str) -> String {
    let key = key.trim().to_ascii_lowercase();
    let one = match key.as_str() {
        "datafile" => "data file",
        "lineskip" => "line skip",
        "byteskip" => "byte skip",
        "blocksize" => "block size",
        "centers" | "centering" | "centres" => "centerings",
        "axismins" => "axis mins",
        "axismaxs" => "axis maxs",
        "oldmin" => "old min",
        "oldmax" => "old max",
        "sampleunits" => "sample units",
        other => other,
    };
    one.to_owned()
}

impl Header {
    fn of(
        version: u8,
        fields: Fields,
        listed: Vec<String>,
        data_offset: u64,
        warnings: Vec<String>,
    ) -> Result<Self, VolumeError> {
        let type_field = fields.require("type")?;
        let dimension = fields.require("dimension")?;
        let axes: usize = dimension.number()?;
        if !(1..=16).contains(&axes) {
            return Err(dimension.bad("a file has 1 to 16 axes", "correct the dimension"));
        }
        let encoding = parse_encoding(fields.require("encoding")?)?;
        let number_or =
            |key: &str, default: i64| fields.get(key).map_or(Ok(default), Field::number);
        let line_skip = fields
            .get("line skip")
            .map_or(Ok(0), Field::number::<u64>)?;
        let byte_skip = number_or("byte skip", 0)?;
        if let Some(field) = fields.get("byte skip").filter(|_| byte_skip < 0)
            && matches!(encoding, Encoding::Text | Encoding::Hex)
        {
            return Err(field.bad("text has no bytes to count from its end", "use a line skip"));
        }
        let data_files = match fields.get("data file") {
            Some(field) => DataFiles::parse(field, listed)?,
            None => DataFiles::Attached,
        };
        Ok(Self {
            version,
            scalar_type: parse_type(type_field)?,
            sizes: fields.require("sizes")?.numbers(axes)?,
            encoding,
            big_endian: fields.get("endian").map(parse_endian).transpose()?,
            line_skip,
            byte_skip,
            data_files,
            data_offset,
            warnings,
            fields,
            segments: BTreeMap::new(),
        })
    }

    /// The unit of space, where all its axes have the same.
    fn length_unit(&self) -> Option<String> {
        let field = self.fields.get("space units")?;
        let mut units = field.value.split('"').skip(1).step_by(2).map(str::trim);
        let first = units.next().filter(|unit| !unit.is_empty())?;
        units.all(|unit| unit == first).then(|| first.to_owned())
    }

    /// Labels, where the file names segments.
    fn segments(&self) -> Values {
        let named = self.segments.values();
        let named: BTreeMap<i64, String> = named
            .filter_map(|segment| Some((segment.label?, segment.name.clone().unwrap_or_default())))
            .collect();
        if named.is_empty() {
            Values::Unknown
        } else {
            Values::Labels(named)
        }
    }

    /// Colours, where the axis of components says so.
    fn components(&self, spatial: &[usize]) -> Components {
        const KINDS: [&str; 4] = ["rgb-color", "rgba-color", "3-color", "4-color"];
        let kinds = self.fields.get("kinds").map(|field| field.value.as_str());
        let kinds = kinds.unwrap_or_default().split_whitespace();
        let color = kinds
            .enumerate()
            .filter(|(axis, _)| !spatial.contains(axis))
            .any(|(_, kind)| KINDS.contains(&kind.to_ascii_lowercase().as_str()));
        if color {
            Components::Colors
        } else {
            Components::Values
        }
    }

    /// Byte order: must be said wherever it matters.
    fn byte_order(&self) -> Result<bool, VolumeError> {
        if self.scalar_type.size() == 1 || self.encoding == Encoding::Text {
            return Ok(false);
        }
        self.big_endian.ok_or_else(|| {
            VolumeError::MissingField(Trouble::new(
                format!(
                    "the header has no `endian`, and {} has two byte orders",
                    self.scalar_type
                ),
                "add `endian: little` or `endian: big`",
            ))
        })
    }
}

fn parse_type(field: &Field) -> Result<ScalarType, VolumeError> {
    if field.value.eq_ignore_ascii_case("block") {
        return Err(VolumeError::Unsupported(Trouble::new(
            "the type `block` is opaque bytes, not numbers",
            "save the file with a number type",
        ))
        .on_line(field.line));
    }
    ScalarType::parse(&field.value).ok_or_else(|| unknown_type(&field.value).on_line(field.line))
}

fn parse_encoding(field: &Field) -> Result<Encoding, VolumeError> {
    Ok(match field.value.to_ascii_lowercase().as_str() {
        "raw" => Encoding::Raw,
        "txt" | "text" | "ascii" => Encoding::Text,
        "hex" => Encoding::Hex,
        "gz" | "gzip" => Encoding::Gzip,
        "bz2" | "bzip2" => Encoding::Bzip2,
        _ => {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("the encoding {:?} is not read", field.value),
                "save the file as raw, gzip, bzip2, hex or ascii",
            ))
            .on_line(field.line));
        }
    })
}

fn parse_endian(field: &Field) -> Result<bool, VolumeError> {
    match field.value.to_ascii_lowercase().as_str() {
        "little" => Ok(false),
        "big" => Ok(true),
        _ => Err(field.bad("that is no byte order", "write `little` or `big`")),
    }
}

pub(crate) fn open<'a>(
    input: &Input<'a>,
    _options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let head = input.head(LONGEST_HEADER)?;
    let mut header = parse_header(&head)?;
    if header.data_offset == LONGEST_HEADER && input.len > LONGEST_HEADER {
        return Err(endless_header());
    }
    let sizes_line = header.fields.get("sizes").map_or(0, |field| field.line);
    let on_sizes = |error: VolumeError| error.on_line(sizes_line);
    let spatial = placement::spatial_axes(&header)?;
    let mut axes = Axes::new(header.sizes.clone(), spatial.clone()).map_err(on_sizes)?;
    if let Some(time) = placement::time_axis(&header, &spatial) {
        axes = axes.with_time(time).map_err(on_sizes)?;
    }
    let count = axes.count().map_err(on_sizes)?;
    let mut warnings = std::mem::take(&mut header.warnings);
    let grid = placement::grid(&header, &spatial, axes.dims(), &mut warnings)?;
    grid.check()?;
    let big_endian = header.byte_order()?;
    let inputs = header.data_files.inputs(input)?;
    if count % inputs.len() as u64 != 0 {
        let files = inputs.len();
        return Err(on_sizes(VolumeError::BadValue(Trouble::new(
            format!("{count} voxels do not spread evenly over {files} data files"),
            "correct the sizes or the list of files",
        ))));
    }
    let attached = header.data_files == DataFiles::Attached;
    let job = Job {
        pieces: inputs
            .into_iter()
            .map(|input| Piece {
                input,
                start: if attached { header.data_offset } else { 0 },
                line_skip: header.line_skip,
                byte_skip: header.byte_skip,
                encoding: header.encoding,
                line_end: true,
                encoded_len: None,
            })
            .collect(),
        scalar_type: header.scalar_type,
        big_endian,
        count,
        what: axes.describe(header.scalar_type),
    };
    let name = crate::input::stem(&input.path);
    let mut contents = Contents::new("NRRD", name, axes.clone(), header.scalar_type, grid);
    contents.about.length_unit = header.length_unit();
    contents.about.values = header.segments();
    contents.components = header.components(&spatial);
    contents.data_files = job.files();
    contents.warnings = warnings;
    contents.sizes_line = sizes_line;
    Ok(Opened {
        contents,
        data: Box::new(Stored {
            job,
            axes,
            rescale: None,
        }),
    })
}
