//! MetaImage (`.mha`, `.mhd`), read as ITK reads it.
//! Source: <https://itk.org/Wiki/MetaIO/Documentation>; where that is silent, what SimpleITK 2.5 does.
//!
//! [`parse_header`] turns `Key = Value` lines up to `ElementDataFile` into a [`Header`] of plain values;
//! `load` checks them and reads the data. The world is LPS already. `TransformMatrix` lists the direction of
//! the first axis, then of the second, then of the third: its rows are the columns of the direction matrix. A
//! negative spacing turns its axis round. The fourth axis is time; channels and axes past it are components.

mod placement;

use glam::DAffine3;
use volgraph_volume::{Grid, ScalarType, Trouble, VolumeError};

use crate::axes::Axes;
use crate::contents::{Contents, Opened};
use crate::data_files::DataFiles;
use crate::fields::{
    Field, Fields, LONGEST_HEADER, endless_header, lines, text_line, warn_unknown,
};
use crate::input::Input;
use crate::load::LoadOptions;
use crate::piece::{Encoding, Piece};
use crate::raw::unknown_type;
use crate::stream::{Job, Stored};

/// Keys that are read, in the spelling of the format. Others are the writer's own and mean nothing here.
const KEYS: [&str; 22] = [
    "ObjectType",
    "NDims",
    "BinaryData",
    "BinaryDataByteOrderMSB",
    "ElementByteOrderMSB",
    "CompressedData",
    "CompressedDataSize",
    "TransformMatrix",
    "Rotation",
    "Orientation",
    "Offset",
    "Position",
    "Origin",
    "ElementSpacing",
    "ElementSize",
    "DimSize",
    "HeaderSize",
    "ElementNumberOfChannels",
    "ElementType",
    "ElementDataFile",
    "ElementToIntensityFunctionSlope",
    "ElementToIntensityFunctionOffset",
];

/// Keys of the format that say nothing about voxels, and that are near to some that do.
const FOREIGN: [&str; 4] = ["ElementMin", "ElementMax", "ObjectSubType", "DistanceUnits"];

/// A header, its values checked one by one but not yet against the data.
#[derive(Debug)]
pub struct Header {
    /// Type of the elements.
    pub scalar_type: ScalarType,
    /// Sizes of the axes, fastest first, without the channels.
    pub sizes: Vec<u64>,
    /// Values per voxel, side by side.
    pub channels: u64,
    /// World from index, LPS; axes past the third are left out, missing ones are padded.
    pub world_from_index: DAffine3,
    /// How the elements are written down.
    pub encoding: Encoding,
    /// Byte order.
    pub big_endian: bool,
    /// Bytes of the compressed stream, where the header tells.
    pub compressed_size: Option<u64>,
    /// Bytes to pass over at the head of a data file; -1 where the data ends the file.
    pub header_size: i64,
    /// Where the data is.
    pub data_files: DataFiles,
    /// Offset behind the header in its own file.
    pub data_offset: u64,
    /// What the user should know.
    pub warnings: Vec<String>,
    sizes_line: u32,
    placement_line: u32,
}

/// Whether a file with this head is MetaImage: its first line is a key that one begins with.
pub(crate) fn is_metaimage(head: &[u8]) -> bool {
    let Some((line, ..)) = lines(head).find(|(line, ..)| !line.trim_ascii().is_empty()) else {
        return false;
    };
    let Some(at) = line.iter().position(|&byte| byte == b'=' || byte == b':') else {
        return false;
    };
    let key = line[..at].trim_ascii();
    [&b"ObjectType"[..], b"NDims", b"ObjectSubType", b"Comment"].contains(&key)
}

/// Reads the header at the beginning of `bytes`; what follows it is not looked at, but for a `LIST`.
///
/// # Errors
/// A [`VolumeError`] without a file, with the line where there is one.
pub fn parse_header(bytes: &[u8]) -> Result<Header, VolumeError> {
    let mut fields = Fields::default();
    let mut warnings = Vec::new();
    let mut all = (1_u32..).zip(lines(bytes));
    let mut data_offset = bytes.len() as u64;
    let mut listed = Vec::new();
    while let Some((number, (line, after, _))) = all.next() {
        if line.trim_ascii().is_empty() {
            continue;
        }
        let field = parse_line(line, number)?;
        let last = field.key == "ElementDataFile";
        let list = last
            && field
                .value
                .split_whitespace()
                .next()
                .is_some_and(|word| word.eq_ignore_ascii_case("list"));
        if KEYS.contains(&field.key.as_str()) {
            fields.push(field)?;
        } else if !FOREIGN.contains(&field.key.as_str()) {
            warn_unknown(&mut warnings, &field, &KEYS, true);
        }
        if last {
            data_offset = after as u64;
            if !list {
                break;
            }
            for (number, (line, ..)) in all.by_ref() {
                let name = text_line(line, number)?.trim();
                if !name.is_empty() {
                    listed.push(name.to_owned());
                }
            }
        }
    }
    Header::of(&fields, listed, data_offset, warnings)
}

fn parse_line(line: &[u8], number: u32) -> Result<Field, VolumeError> {
    let at = line
        .iter()
        .position(|&byte| byte == b'=' || byte == b':')
        .ok_or_else(|| {
            let start: String = String::from_utf8_lossy(line).chars().take(40).collect();
            VolumeError::HeaderSyntax(Trouble::new(
                format!("the line {start:?} is no field"),
                "write `Key = Value`, and end the header with `ElementDataFile = ...`",
            ))
            .on_line(number)
        })?;
    let key = text_line(line[..at].trim_ascii(), number)?.to_owned();
    let value = &line[at + 1..];
    // A value that is not read may be in any encoding.
    let value = if KEYS.contains(&key.as_str()) {
        text_line(value, number)?.trim().to_owned()
    } else {
        String::new()
    };
    Ok(Field {
        key,
        value,
        line: number,
    })
}

impl Header {
    fn of(
        fields: &Fields,
        listed: Vec<String>,
        data_offset: u64,
        mut warnings: Vec<String>,
    ) -> Result<Self, VolumeError> {
        if let Some(field) = fields
            .get("ObjectType")
            .filter(|field| field.value != "Image")
        {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("the object is a {:?}, not an Image", field.value),
                "give a MetaImage file",
            ))
            .on_line(field.line));
        }
        let ndims = fields.require("NDims")?;
        let axes: usize = ndims.number()?;
        if !(1..=10).contains(&axes) {
            return Err(ndims.bad("an image has 1 to 10 axes", "correct the number of axes"));
        }
        let sizes = fields.require("DimSize")?;
        let type_field = fields.require("ElementType")?;
        // An array of a type is its elements, channel by channel.
        let type_name = type_field
            .value
            .strip_suffix("_ARRAY")
            .unwrap_or(&type_field.value);
        let scalar_type = ScalarType::parse(type_name)
            .filter(|_| type_name.starts_with("MET_"))
            .ok_or_else(|| unknown_type(&type_field.value).on_line(type_field.line))?;
        let data = fields.require("ElementDataFile")?;
        let data_files = match data.value.as_str() {
            "LOCAL" | "Local" | "local" => DataFiles::Attached,
            _ => DataFiles::parse(data, listed)?,
        };
        for key in [
            "ElementToIntensityFunctionSlope",
            "ElementToIntensityFunctionOffset",
        ] {
            let neutral = if key.ends_with("Slope") { 1.0 } else { 0.0 };
            if let Some(field) = fields
                .get(key)
                .filter(|field| field.number() != Ok(neutral))
            {
                warnings.push(format!(
                    "line {}: `{key}` is not applied to the voxels",
                    field.line
                ));
            }
        }
        let (world_from_index, placement_line) = placement::world_from_index(fields, axes)?;
        let flag = |key: &str| fields.get(key).map_or(Ok(false), boolean);
        let binary = fields.get("BinaryData").map_or(Ok(true), boolean)?;
        let compressed = flag("CompressedData")?;
        let encoding = match (binary, compressed) {
            (true, false) => Encoding::Raw,
            (true, true) => Encoding::Zlib,
            (false, false) => Encoding::Text,
            (false, true) => {
                return Err(VolumeError::Unsupported(Trouble::new(
                    "text data that is compressed is not read",
                    "save the file with BinaryData = True",
                )));
            }
        };
        let size = fields.get("CompressedDataSize").filter(|_| compressed);
        let compressed_size = size
            .map(Field::number::<u64>)
            .transpose()?
            .filter(|&size| size > 0);
        let header_size = fields
            .get("HeaderSize")
            .map_or(Ok(0), Field::number::<i64>)?;
        if let Some(field) = fields.get("HeaderSize")
            && (header_size < -1 || (header_size == -1 && encoding != Encoding::Raw))
        {
            return Err(field.bad(
                "that is neither a number of bytes nor the -1 of plain data",
                "write the bytes before the data, or -1",
            ));
        }
        Ok(Self {
            scalar_type,
            sizes: sizes.numbers(axes)?,
            channels: match fields.get("ElementNumberOfChannels") {
                Some(field) => match field.number()? {
                    0 => return Err(field.bad("a voxel has at least one value", "write 1")),
                    channels => channels,
                },
                None => 1,
            },
            world_from_index,
            encoding,
            big_endian: flag("BinaryDataByteOrderMSB")? || flag("ElementByteOrderMSB")?,
            compressed_size,
            header_size,
            data_files,
            data_offset,
            warnings,
            sizes_line: sizes.line,
            placement_line,
        })
    }
}

fn boolean(field: &Field) -> Result<bool, VolumeError> {
    match field.value.to_ascii_lowercase().as_str() {
        "true" | "t" | "1" => Ok(true),
        "false" | "f" | "0" => Ok(false),
        _ => Err(field.bad("that is neither true nor false", "write True or False")),
    }
}

pub(crate) fn open<'a>(
    input: &Input<'a>,
    _options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let head = input.head(LONGEST_HEADER)?;
    let header = parse_header(&head)?;
    if header.data_offset == LONGEST_HEADER && input.len > LONGEST_HEADER {
        return Err(endless_header());
    }
    let on_sizes = |error: VolumeError| error.on_line(header.sizes_line);
    let channel_axes = usize::from(header.channels > 1);
    let mut sizes = header.sizes.clone();
    if channel_axes == 1 {
        sizes.insert(0, header.channels);
    }
    let spatial = (0..header.sizes.len().min(3))
        .map(|axis| axis + channel_axes)
        .collect();
    let mut axes = Axes::new(sizes, spatial).map_err(on_sizes)?;
    if header.sizes.len() > 3 {
        axes = axes.with_time(3 + channel_axes).map_err(on_sizes)?;
    }
    let count = axes.count().map_err(on_sizes)?;
    let grid = Grid {
        dims: axes.dims(),
        world_from_index: header.world_from_index,
        node_centred: false,
    };
    grid.check()
        .map_err(|error| error.on_line(header.placement_line))?;
    let inputs = header.data_files.inputs(input)?;
    if count % inputs.len() as u64 != 0 {
        let files = inputs.len();
        return Err(on_sizes(VolumeError::BadValue(Trouble::new(
            format!("{count} voxels do not spread evenly over {files} data files"),
            "correct DimSize or the list of files",
        ))));
    }
    let (start, byte_skip) = data_start(&header)?;
    let job = Job {
        pieces: inputs
            .into_iter()
            .map(|input| Piece {
                input,
                start,
                line_skip: 0,
                byte_skip,
                encoding: header.encoding,
                line_end: true,
                encoded_len: header.compressed_size,
            })
            .collect(),
        scalar_type: header.scalar_type,
        big_endian: header.big_endian,
        count,
        what: axes.describe(header.scalar_type),
    };
    let name = crate::input::stem(&input.path);
    let mut contents = Contents::new("MetaImage", name, axes.clone(), header.scalar_type, grid);
    contents.data_files = job.files();
    contents.warnings = header.warnings;
    contents.sizes_line = header.sizes_line;
    Ok(Opened {
        contents,
        data: Box::new(Stored {
            job,
            axes,
            rescale: None,
        }),
    })
}

/// Where the data begins, and a skip of -1 where it ends the file. In a local file `HeaderSize` counts from
/// the beginning of the file, and must not point into the header.
fn data_start(header: &Header) -> Result<(u64, i64), VolumeError> {
    let local = header.data_files == DataFiles::Attached;
    match u64::try_from(header.header_size) {
        Err(_) => Ok((if local { header.data_offset } else { 0 }, -1)),
        Ok(0) if local => Ok((header.data_offset, 0)),
        Ok(size) if local && size < header.data_offset => Err(VolumeError::BadValue(Trouble::new(
            format!(
                "`HeaderSize` is {size}, and the header itself has {} bytes",
                header.data_offset
            ),
            "leave HeaderSize out of a local file",
        ))),
        // Passed over before decompression, as the file says: the stream begins behind it.
        Ok(size) => Ok((size, 0)),
    }
}
