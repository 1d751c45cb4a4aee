//! Formats that are little more than the voxels: raw and NumPy's `.npy`.

use std::path::Path;

use volgraph_volume::{ScalarType, Trouble, Volume, VolumeError};

use super::target::{Packing, Source, TempFile};
use super::{
    NO_COLORS, NO_NODES, NO_PLACE, WriteOptions, Written, deflate_level, ends_with, placed,
};
use crate::raw::parse_raw_name;

/// Plain voxels; the name must describe them, for nothing else does.
pub(super) fn write_raw(
    volume: &Volume,
    path: &Path,
    options: &WriteOptions,
) -> Result<Written, VolumeError> {
    let level = deflate_level(path, options);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let [nx, ny, nz] = volume.grid().dims;
    let ty = volume.voxels().scalar_type();
    let packed = if level.is_some() { ".gz" } else { "" };
    let right = |cause: String| {
        VolumeError::RawName(Trouble::new(
            cause,
            format!("name it {}_{nx}x{ny}x{nz}_{ty}.raw{packed}", volume.name()),
        ))
    };
    let said = parse_raw_name(&name).map_err(|error| right(error.trouble().cause.clone()))?;
    if said.dims != volume.grid().dims || said.scalar_type != ty {
        return Err(right(format!(
            "the name {name:?} does not describe {nx}x{ny}x{nz} {ty}"
        )));
    }
    if said.big_endian == Some(true) {
        return Err(right("raw voxels are written little-endian".to_owned()));
    }
    if level.is_some() != ends_with(path, ".gz") {
        let cause = if level.is_some() {
            "compressed voxels and a name without `.gz`"
        } else {
            "a name that ends in `.gz`, and no compression"
        };
        return Err(right(cause.to_owned()));
    }
    let mut written = warned(volume);
    if volume.colors().is_some() {
        written.warnings.push(NO_COLORS.to_owned());
    }
    let mut file = TempFile::beside(path)?;
    file.put_voxels(
        &Source::scalars(volume),
        Packing::gzip(level),
        &options.watch,
    )?;
    file.finish(options, &mut written)?;
    Ok(written)
}

fn warned(volume: &Volume) -> Written {
    let mut written = Written::default();
    if placed(volume) {
        written.warnings.push(NO_PLACE.to_owned());
    }
    if volume.grid().node_centred {
        written.warnings.push(NO_NODES.to_owned());
    }
    written
}

/// An array of shape z, y, x, and 4 where there are colours.
/// Source: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.
pub(super) fn write_npy(
    volume: &Volume,
    path: &Path,
    options: &WriteOptions,
) -> Result<Written, VolumeError> {
    let source = Source::colored(volume);
    let ty = if source.colors {
        ScalarType::U8
    } else {
        volume.voxels().scalar_type()
    };
    let kind = match ty {
        _ if ty.is_float() => 'f',
        ScalarType::I8 | ScalarType::I16 | ScalarType::I32 | ScalarType::I64 => 'i',
        _ => 'u',
    };
    let order = if ty.size() == 1 { '|' } else { '<' };
    let [nx, ny, nz] = volume.grid().dims;
    let last = if source.colors { ", 4" } else { "" };
    let mut head = format!(
        "{{'descr': '{order}{kind}{}', 'fortran_order': False, 'shape': ({nz}, {ny}, {nx}{last}), }}",
        ty.size()
    );
    // Magic, version and length are 10 bytes; the header ends in a line end at a multiple of 64.
    let padding = 63 - (10 + head.len()) % 64;
    head.push_str(&" ".repeat(padding));
    head.push('\n');
    let len = u16::try_from(head.len()).unwrap_or(u16::MAX);
    let mut written = warned(volume);
    let mut file = TempFile::beside(path)?;
    file.put(b"\x93NUMPY\x01\x00")?;
    file.put(&len.to_le_bytes())?;
    file.put(head.as_bytes())?;
    file.put_voxels(&source, Packing::None, &options.watch)?;
    file.finish(options, &mut written)?;
    Ok(written)
}
