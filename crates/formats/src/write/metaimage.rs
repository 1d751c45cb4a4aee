//! MetaImage as ITK writes it: LPS, attached or with a data file, raw or zlib.

use std::path::Path;

use glam::DVec3;
use volgraph_volume::{ScalarType, Volume, VolumeError};

use super::target::{Packing, Source, TempFile, check};
use super::{NO_NODES, WriteOptions, Written, beside, deflate_level, ends_with};

/// Digits of a number that is known only at the end.
const DIGITS: usize = 20;

pub(super) fn write(
    volume: &Volume,
    path: &Path,
    options: &WriteOptions,
) -> Result<Written, VolumeError> {
    let source = Source::colored(volume);
    let level = deflate_level(path, options);
    let packing = level.map_or(Packing::None, Packing::Zlib);
    let detached = ends_with(path, ".mhd");
    let data = beside(path, if level.is_some() { "zraw" } else { "raw" });
    let mut head = header(volume, source.colors);
    let mut size_at = None;
    if level.is_some() {
        head.push_str("CompressedData = True\nCompressedDataSize = ");
        size_at = Some(head.len() as u64);
        head.push_str(&" ".repeat(DIGITS));
        head.push('\n');
    } else {
        head.push_str("CompressedData = False\n");
    }
    let name = data.file_name().unwrap_or_default().to_string_lossy();
    head.push_str(&format!(
        "ElementType = {}\nElementDataFile = {}\n",
        type_name(if source.colors {
            ScalarType::U8
        } else {
            volume.voxels().scalar_type()
        }),
        if detached { &*name } else { "LOCAL" },
    ));
    let mut written = Written::default();
    if volume.grid().node_centred {
        written.warnings.push(NO_NODES.to_owned());
    }
    let mut file = TempFile::beside(path)?;
    file.put(head.as_bytes())?;
    if !detached {
        file.put_voxels(&source, packing, &options.watch)?;
        let size = file.len()? - head.len() as u64;
        put_size(&mut file, size_at, size)?;
        file.finish(options, &mut written)?;
        return Ok(written);
    }
    check(&data, false, options)?;
    let mut voxels = TempFile::beside(&data)?;
    voxels.put_voxels(&source, packing, &options.watch)?;
    let size = voxels.len()?;
    put_size(&mut file, size_at, size)?;
    voxels.finish(options, &mut written)?;
    file.finish(options, &mut written)?;
    written.files.reverse();
    Ok(written)
}

fn put_size(file: &mut TempFile, at: Option<u64>, size: u64) -> Result<(), VolumeError> {
    match at {
        Some(at) => file.put_at(at, format!("{size:<DIGITS$}").as_bytes()),
        None => Ok(()),
    }
}

fn header(volume: &Volume, colors: bool) -> String {
    let grid = volume.grid();
    let spacing = grid.spacing();
    let matrix = grid.world_from_index.matrix3;
    let directions = [
        matrix.x_axis / spacing.x,
        matrix.y_axis / spacing.y,
        matrix.z_axis / spacing.z,
    ];
    // The reader multiplies direction and spacing; an axis along the world's is exact that way.
    let directions: Vec<String> = directions
        .iter()
        .flat_map(DVec3::to_array)
        .map(|value| value.to_string())
        .collect();
    let origin = grid.origin();
    let [nx, ny, nz] = grid.dims;
    let channels = if colors {
        "ElementNumberOfChannels = 4\n"
    } else {
        ""
    };
    format!(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n\
         TransformMatrix = {}\nOffset = {} {} {}\nElementSpacing = {} {} {}\nDimSize = {nx} {ny} {nz}\n{channels}",
        directions.join(" "),
        origin.x,
        origin.y,
        origin.z,
        spacing.x,
        spacing.y,
        spacing.z,
    )
}

fn type_name(ty: ScalarType) -> &'static str {
    match ty {
        ScalarType::U8 => "MET_UCHAR",
        ScalarType::I8 => "MET_CHAR",
        ScalarType::U16 => "MET_USHORT",
        ScalarType::I16 => "MET_SHORT",
        ScalarType::U32 => "MET_UINT",
        ScalarType::I32 => "MET_INT",
        ScalarType::U64 => "MET_ULONG_LONG",
        ScalarType::I64 => "MET_LONG_LONG",
        ScalarType::F32 => "MET_FLOAT",
        ScalarType::F64 => "MET_DOUBLE",
    }
}
