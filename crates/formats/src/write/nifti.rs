//! NIfTI-1 and NIfTI-2, one file, little-endian.
//! Source: <https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h>, `nifti2.h` beside it.
//!
//! The placement is turned from LPS to RAS and written as the sform; as the qform too where the axes are
//! perpendicular, for that is all a quaternion can say. NIfTI-1 has float32 there.

use std::path::Path;

use glam::{DMat3, DVec3};
use volgraph_volume::{ScalarType, Trouble, Values, Volume, VolumeError};

use super::target::{Packing, Source, TempFile};
use super::{NO_NODES, WriteOptions, Written, deflate_level, ends_with};

/// The longest axis of NIfTI-1.
const LONGEST: u32 = i16::MAX as u32;

/// How far from perpendicular axes may be for a quaternion.
const PERPENDICULAR: f64 = 1e-9;

pub(super) fn write(
    volume: &Volume,
    path: &Path,
    options: &WriteOptions,
    second: bool,
) -> Result<Written, VolumeError> {
    let level = deflate_level(path, options);
    if level.is_some() != ends_with(path, ".gz") {
        return Err(VolumeError::Write(Trouble::new(
            "readers of NIfTI know compression by the ending `.gz` alone",
            "end the name in `.nii.gz` and compress, or in `.nii` and do not",
        )));
    }
    let source = Source::colored(volume);
    let grid = volume.grid();
    let second = second || grid.dims.iter().any(|&n| n > LONGEST);
    let mut written = Written::default();
    if grid.node_centred {
        written.warnings.push(NO_NODES.to_owned());
    }
    let place = Place::of(volume);
    let rounded = place.rounding();
    if !second && rounded > 0.0 {
        written.warnings.push(format!(
            "NIfTI-1 has the placement in float32: it moved by up to {rounded:.1e}; NIfTI-2 keeps all digits"
        ));
    }
    let head = if second {
        header_2(volume, source.colors, &place)
    } else {
        header_1(volume, source.colors, &place)
    };
    let mut file = TempFile::beside(path)?;
    match level {
        Some(level) => file.put_packed(&head, &source, level, &options.watch)?,
        None => {
            file.put(&head)?;
            file.put_voxels(&source, Packing::None, &options.watch)?;
        }
    }
    file.finish(options, &mut written)?;
    Ok(written)
}

/// A placement in RAS.
struct Place {
    spacing: DVec3,
    /// Rows of the map from index to RAS.
    rows: [[f64; 4]; 3],
    /// The quaternion's b, c, d and the sign of the third axis.
    turn: Option<([f64; 3], f64)>,
}

impl Place {
    fn of(volume: &Volume) -> Self {
        let grid = volume.grid();
        let flip = DVec3::new(-1.0, -1.0, 1.0);
        let matrix = DMat3::from_diagonal(flip) * grid.world_from_index.matrix3;
        let origin = flip * grid.origin();
        // Adding 0 makes one zero of the two.
        let rows = [0, 1, 2].map(|row| {
            let [x, y, z] = matrix.row(row).to_array();
            [x, y, z, origin[row]].map(|value| value + 0.0)
        });
        let spacing = grid.spacing();
        let unit = DMat3::from_cols(
            matrix.x_axis / spacing.x,
            matrix.y_axis / spacing.y,
            matrix.z_axis / spacing.z,
        );
        let gram = unit.transpose() * unit;
        let turn = gram.abs_diff_eq(DMat3::IDENTITY, PERPENDICULAR).then(|| {
            let sign = if unit.determinant() < 0.0 { -1.0 } else { 1.0 };
            let turn = DMat3::from_cols(unit.x_axis, unit.y_axis, unit.z_axis * sign);
            let mut turn = glam::DQuat::from_mat3(&turn).normalize();
            // The first number is not written: it is taken as positive.
            if turn.w < 0.0 {
                turn = -turn;
            }
            ([turn.x, turn.y, turn.z].map(|value| value + 0.0), sign)
        });
        Self {
            spacing,
            rows,
            turn,
        }
    }

    /// The largest change by float32.
    fn rounding(&self) -> f64 {
        let values = self.rows.as_flattened().iter();
        values
            .map(|&value| (f64::from(value as f32) - value).abs())
            .fold(0.0, f64::max)
    }
}

/// `datatype` and `bitpix`.
fn type_code(volume: &Volume, colors: bool) -> (i16, i16) {
    if colors {
        return (2304, 32);
    }
    let ty = volume.voxels().scalar_type();
    let code = match ty {
        ScalarType::U8 => 2,
        ScalarType::I16 => 4,
        ScalarType::I32 => 8,
        ScalarType::F32 => 16,
        ScalarType::F64 => 64,
        ScalarType::I8 => 256,
        ScalarType::U16 => 512,
        ScalarType::U32 => 768,
        ScalarType::I64 => 1024,
        ScalarType::U64 => 1280,
    };
    (code, i16::try_from(ty.size() * 8).unwrap_or(0))
}

/// `xyzt_units`, 0 where the unit is unknown or none of the format's.
fn unit_code(volume: &Volume) -> u8 {
    match volume.about().length_unit.as_deref() {
        Some("m" | "metre" | "meter") => 1,
        Some("mm" | "millimetre" | "millimeter") => 2,
        Some("µm" | "μm" | "um" | "micrometre" | "micrometer") => 3,
        _ => 0,
    }
}

/// `intent_code`: labels have one of their own.
fn intent(volume: &Volume) -> i16 {
    match volume.about().values {
        Values::Labels(_) => 1002,
        _ => 0,
    }
}

/// At most 79 bytes of text and a zero.
fn description() -> [u8; 80] {
    let mut text = [0; 80];
    text[..8].copy_from_slice(b"volgraph");
    text
}

/// Bytes one after the other.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn u8(&mut self, value: u8) {
        self.0.push(value);
    }
    fn i16(&mut self, value: i16) {
        self.0.extend(value.to_le_bytes());
    }
    fn i32(&mut self, value: i32) {
        self.0.extend(value.to_le_bytes());
    }
    fn i64(&mut self, value: i64) {
        self.0.extend(value.to_le_bytes());
    }
    fn f32s(&mut self, values: &[f64]) {
        values
            .iter()
            .for_each(|&value| self.0.extend((value as f32).to_le_bytes()));
    }
    fn f64s(&mut self, values: &[f64]) {
        values
            .iter()
            .for_each(|value| self.0.extend(value.to_le_bytes()));
    }
    fn zeros(&mut self, count: usize) {
        self.0.resize(self.0.len() + count, 0);
    }
}

/// 348 bytes of header and 4 of "no extension".
fn header_1(volume: &Volume, colors: bool, place: &Place) -> Vec<u8> {
    let mut out = Bytes::default();
    let (code, bits) = type_code(volume, colors);
    let ([b, c, d], sign) = place.turn.unwrap_or_default();
    out.i32(348);
    out.zeros(35);
    out.u8(0);
    out.i16(3);
    // They fit, or this were NIfTI-2.
    volume
        .grid()
        .dims
        .iter()
        .for_each(|&n| out.i16(i16::try_from(n).unwrap_or(i16::MAX)));
    (0..4).for_each(|_| out.i16(1));
    out.zeros(12);
    out.i16(intent(volume));
    out.i16(code);
    out.i16(bits);
    out.i16(0);
    let sign = if sign == 0.0 { 1.0 } else { sign };
    out.f32s(&[sign]);
    out.f32s(&place.spacing.to_array());
    out.f32s(&[1.0; 4]);
    out.f32s(&[352.0, 1.0, 0.0]);
    out.i16(0);
    out.u8(0);
    out.u8(unit_code(volume));
    out.zeros(24);
    out.0.extend(description());
    out.zeros(24);
    out.i16(i16::from(place.turn.is_some()));
    out.i16(1);
    out.f32s(&[b, c, d]);
    out.f32s(&place.rows.map(|row| row[3]));
    out.f32s(place.rows.as_flattened());
    out.zeros(16);
    out.0.extend(b"n+1\0");
    out.zeros(4);
    debug_assert_eq!(out.0.len(), 352);
    out.0
}

/// 540 bytes of header and 4 of "no extension".
fn header_2(volume: &Volume, colors: bool, place: &Place) -> Vec<u8> {
    let mut out = Bytes::default();
    let (code, bits) = type_code(volume, colors);
    let ([b, c, d], sign) = place.turn.unwrap_or_default();
    out.i32(540);
    out.0.extend(b"n+2\0\r\n\x1a\n");
    out.i16(code);
    out.i16(bits);
    out.i64(3);
    volume.grid().dims.iter().for_each(|&n| out.i64(n.into()));
    (0..4).for_each(|_| out.i64(1));
    out.zeros(24);
    let sign = if sign == 0.0 { 1.0 } else { sign };
    out.f64s(&[sign]);
    out.f64s(&place.spacing.to_array());
    out.f64s(&[1.0; 4]);
    out.i64(544);
    out.f64s(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    out.zeros(16);
    out.0.extend(description());
    out.zeros(24);
    out.i32(i32::from(place.turn.is_some()));
    out.i32(1);
    out.f64s(&[b, c, d]);
    out.f64s(&place.rows.map(|row| row[3]));
    out.f64s(place.rows.as_flattened());
    out.i32(0);
    out.i32(unit_code(volume).into());
    out.i32(intent(volume).into());
    out.zeros(16);
    out.u8(0);
    out.zeros(15);
    out.zeros(4);
    debug_assert_eq!(out.0.len(), 544);
    out.0
}
