//! The header of both versions as one set of numbers.
//!
//! Version 1 (348 bytes) is parsed by the crate `nifti`. Version 2 (540 bytes) has wider numbers in another order,
//! which the crate does not read; they are taken from their offsets here.

use nifti::{Endianness, NiftiHeader};
use volgraph_volume::{Trouble, VolumeError};

/// Bytes of the longer header.
pub(super) const LONGEST: u64 = SIZE_2 as u64;

const SIZE_1: usize = 348;
const SIZE_2: usize = 540;

/// What the header says; numbers of version 1 are widened.
#[derive(Debug)]
pub(super) struct Header {
    pub version: u8,
    pub big_endian: bool,
    /// Whether the voxels lie in the same file.
    pub attached: bool,
    pub dim: [i64; 8],
    pub datatype: i16,
    pub pixdim: [f64; 8],
    /// Where the voxels begin, unchecked.
    vox_offset: f64,
    pub slope: f64,
    pub intercept: f64,
    pub units: i32,
    pub toffset: f64,
    pub intent: i32,
    pub intent_name: String,
    pub description: String,
    pub qform: i32,
    pub sform: i32,
    /// Quaternion b, c, d, and the offset behind it.
    pub quatern: [f64; 3],
    pub qoffset: [f64; 3],
    /// Rows of the affine map.
    pub srow: [[f64; 4]; 3],
    /// Largest w² of a quaternion that counts as 0: what the digits of the header cannot tell.
    pub quatern_margin: f64,
    pub warnings: Vec<String>,
}

/// The version that the first bytes tell; 0 for Analyze 7.5, which has the size of NIfTI-1 without its magic.
pub(super) fn version(bytes: &[u8]) -> Option<u8> {
    let size = bytes.first_chunk::<4>()?;
    let (little, big) = (i32::from_le_bytes(*size), i32::from_be_bytes(*size));
    if matches!(bytes.get(344..348), Some(b"n+1\0" | b"ni1\0")) {
        return Some(1);
    }
    if matches!(bytes.get(4..8), Some(b"n+2\0" | b"ni2\0")) {
        return Some(2);
    }
    match (little, big) {
        (348, _) | (_, 348) => Some(0),
        (540, _) | (_, 540) => Some(2),
        _ => None,
    }
}

fn bad(cause: impl Into<String>, remedy: &str) -> VolumeError {
    VolumeError::BadValue(Trouble::new(cause, remedy))
}

impl Header {
    /// The header at the beginning of `bytes`.
    pub fn parse(bytes: &[u8]) -> Result<Self, VolumeError> {
        let short = |need: usize| {
            VolumeError::DataTooShort(Trouble::new(
                format!("holds {} bytes of a header of {need}", bytes.len()),
                "the file is cut off: fetch it again",
            ))
        };
        let mut header = match version(bytes) {
            Some(1) => Self::one(bytes)?,
            Some(2) => Self::two(bytes).ok_or_else(|| short(SIZE_2))??,
            _ if bytes.len() < SIZE_1 => return Err(short(SIZE_1)),
            _ => {
                return Err(VolumeError::Unsupported(Trouble::new(
                    "the header has the size of NIfTI's without its magic: Analyze 7.5, which does not say where \
                     left and right are",
                    "convert the file to NIfTI with a tool that knows where it comes from",
                )));
            }
        };
        header.mend();
        Ok(header)
    }

    fn one(bytes: &[u8]) -> Result<Self, VolumeError> {
        let h = NiftiHeader::from_reader(bytes).map_err(|error| {
            VolumeError::HeaderSyntax(Trouble::new(
                format!("the NIfTI-1 header cannot be read: {error}"),
                "fetch the file again",
            ))
        })?;
        // The crate takes the byte order that makes the number of axes small; the size of the header knows better.
        let big_endian = h.endianness == Endianness::Big;
        let size = bytes.first_chunk().copied().unwrap_or_default();
        if if big_endian {
            i32::from_le_bytes(size)
        } else {
            i32::from_be_bytes(size)
        } == 348
        {
            return Err(bad(
                "the header has no number of axes from 1 to 7",
                "fetch the file again",
            ));
        }
        let mut warnings = Vec::new();
        if h.sizeof_hdr != 348 {
            warnings.push(format!(
                "the header says that it has {} bytes; 348 are read",
                h.sizeof_hdr
            ));
        }
        let attached = &h.magic == b"n+1\0";
        let wide = |row: [f32; 4]| row.map(f64::from);
        Ok(Self {
            version: 1,
            big_endian,
            attached,
            dim: h.dim.map(|size| i64::from(size.cast_signed())),
            datatype: h.datatype,
            pixdim: h.pixdim.map(f64::from),
            vox_offset: h.vox_offset.into(),
            slope: h.scl_slope.into(),
            intercept: h.scl_inter.into(),
            units: h.xyzt_units.into(),
            toffset: h.toffset.into(),
            intent: h.intent_code.into(),
            intent_name: text(&h.intent_name),
            description: text(&h.descrip),
            qform: h.qform_code.into(),
            sform: h.sform_code.into(),
            quatern: [h.quatern_b, h.quatern_c, h.quatern_d].map(f64::from),
            qoffset: [h.quatern_x, h.quatern_y, h.quatern_z].map(f64::from),
            srow: [wide(h.srow_x), wide(h.srow_y), wide(h.srow_z)],
            quatern_margin: 3.0 * f64::from(f32::EPSILON),
            warnings,
        })
    }

    /// `None` where the bytes end too early.
    fn two(bytes: &[u8]) -> Option<Result<Self, VolumeError>> {
        let bytes: &[u8; SIZE_2] = bytes.first_chunk()?;
        let size = bytes.first_chunk::<4>()?;
        let big_endian = i32::from_be_bytes(*size) == 540;
        let at = At { bytes, big_endian };
        let mut warnings = Vec::new();
        if !big_endian && i32::from_le_bytes(*size) != 540 {
            return Some(Err(bad(
                "the header has the magic of NIfTI-2, and its size is not 540",
                "fetch the file again",
            )));
        }
        let attached = match at.take::<4>(4)? {
            m if &m == b"n+2\0" => true,
            m if &m == b"ni2\0" => false,
            m => {
                return Some(Err(VolumeError::HeaderSyntax(Trouble::new(
                    format!(
                        "the header has the size of NIfTI-2's, and its magic is {:?}",
                        text(&m)
                    ),
                    "fetch the file again",
                ))));
            }
        };
        match &at.take::<4>(8)? {
            b"\r\n\x1a\n" => {}
            [0, 0, 0, 0] => warnings.push("the four bytes behind the magic are 0".to_owned()),
            _ => {
                return Some(Err(VolumeError::DataCorrupt(Trouble::new(
                    "line ends were converted in this file as if it were text",
                    "fetch the file again, in binary mode",
                ))));
            }
        }
        let row = |from: usize| {
            Some([
                at.f64(from)?,
                at.f64(from + 8)?,
                at.f64(from + 16)?,
                at.f64(from + 24)?,
            ])
        };
        let three = |from: usize| Some([at.f64(from)?, at.f64(from + 8)?, at.f64(from + 16)?]);
        let (mut dim, mut pixdim) = ([0; 8], [0.0; 8]);
        for axis in 0..8 {
            dim[axis] = at.i64(16 + 8 * axis)?;
            pixdim[axis] = at.f64(104 + 8 * axis)?;
        }
        Some(Ok(Self {
            version: 2,
            big_endian,
            attached,
            dim,
            datatype: at.i16(12)?,
            pixdim,
            // Exact up to 2^53 bytes.
            vox_offset: at.i64(168)? as f64,
            slope: at.f64(176)?,
            intercept: at.f64(184)?,
            units: at.i32(500)?,
            toffset: at.f64(216)?,
            intent: at.i32(504)?,
            intent_name: text(&at.take::<16>(508)?),
            description: text(&at.take::<80>(240)?),
            qform: at.i32(344)?,
            sform: at.i32(348)?,
            quatern: three(352)?,
            qoffset: three(376)?,
            srow: [row(400)?, row(432)?, row(464)?],
            quatern_margin: 3.0 * f64::EPSILON,
            warnings,
        }))
    }

    /// What nibabel mends: codes that do not exist, voxels without a size, a handedness that is none.
    fn mend(&mut self) {
        for (name, code) in [
            ("qform_code", &mut self.qform),
            ("sform_code", &mut self.sform),
        ] {
            if !(0..=5).contains(code) {
                self.warnings.push(format!(
                    "{name} is {code}, which does not exist; taken as 0"
                ));
                *code = 0;
            }
        }
        let axes = usize::try_from(self.dim[0]).unwrap_or(0).min(3);
        let placed = self.sform > 0;
        for axis in 1..4 {
            let size = self.pixdim[axis];
            let mended = if size == 0.0 { 1.0 } else { size.abs() };
            self.pixdim[axis] = mended;
            if mended.to_bits() != size.to_bits() && !placed && axis <= axes {
                self.warnings.push(format!(
                    "the voxel size pixdim[{axis}] is {size}; taken as {mended}"
                ));
            }
        }
        if self.pixdim[0].abs() != 1.0 {
            if self.qform > 0 && !placed {
                self.warnings.push(format!(
                    "the handedness pixdim[0] is {}; taken as 1",
                    self.pixdim[0]
                ));
            }
            self.pixdim[0] = 1.0;
        }
    }

    /// Where the voxels begin: an offset of 0 means right behind the header, and its fraction nothing.
    pub fn voxels_at(&self) -> Result<u64, VolumeError> {
        let least = match (self.attached, self.version) {
            (false, _) => 0,
            (true, 1) => 352,
            (true, _) => 544,
        };
        let offset = self.vox_offset;
        if offset == 0.0 {
            return Ok(least);
        }
        if !(least as f64..1e18).contains(&offset) {
            return Err(bad(
                format!(
                    "the voxels begin at vox_offset = {offset:e}, and the header ends at {least}"
                ),
                "fetch the file again, or correct vox_offset in its header",
            ));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "its range was seen"
        )]
        Ok(offset as u64)
    }

    /// Sizes of the axes that are there.
    pub fn sizes(&self) -> Result<Vec<u64>, VolumeError> {
        let remedy = "fetch the file again, or correct the dimensions in its header";
        let Some(axes) = usize::try_from(self.dim[0])
            .ok()
            .filter(|axes| (1..=7).contains(axes))
        else {
            return Err(bad(
                format!("the header says {} axes; there are 1 to 7", self.dim[0]),
                remedy,
            ));
        };
        let sizes = self.dim[1..=axes].iter().enumerate();
        sizes
            .map(|(axis, &size)| {
                u64::try_from(size)
                    .map_err(|_| bad(format!("axis {} has {size} samples", axis + 1), remedy))
            })
            .collect()
    }
}

/// Text up to the first 0, without what cannot be shown.
fn text(bytes: &[u8]) -> String {
    let end = bytes
        .iter()
        .position(|&byte| byte == 0)
        .unwrap_or(bytes.len());
    let text = String::from_utf8_lossy(&bytes[..end]);
    let shown = text
        .chars()
        .filter(|letter| !letter.is_control() && *letter != '\u{fffd}');
    shown.collect::<String>().trim().to_owned()
}

/// Numbers at offsets of a header, in its byte order.
struct At<'a> {
    bytes: &'a [u8; SIZE_2],
    big_endian: bool,
}

impl At<'_> {
    fn take<const N: usize>(&self, from: usize) -> Option<[u8; N]> {
        self.bytes.get(from..)?.first_chunk().copied()
    }

    fn ordered<const N: usize>(&self, from: usize) -> Option<[u8; N]> {
        let mut bytes = self.take(from)?;
        if self.big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn i16(&self, from: usize) -> Option<i16> {
        self.ordered(from).map(i16::from_le_bytes)
    }

    fn i32(&self, from: usize) -> Option<i32> {
        self.ordered(from).map(i32::from_le_bytes)
    }

    fn i64(&self, from: usize) -> Option<i64> {
        self.ordered(from).map(i64::from_le_bytes)
    }

    fn f64(&self, from: usize) -> Option<f64> {
        self.ordered(from).map(f64::from_le_bytes)
    }
}
