//! NumPy's `.npy`, versions 1 to 3. Source: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.
//!
//! The last index of the array is x, whichever order the array is stored in: an array `a[z, y, x]`, as pictures are
//! indexed. Four axes with two to four values on the last one are a volume with components. The file knows neither
//! spacing nor place: voxels are cubes of length 1, the first one at the origin.
//!
//! The crate `npyz` parses the header, a Python literal. It multiplies the sizes unchecked, allocates what the length
//! of the header says, and its parser takes exponential time over nested brackets; so `check_text` lets pass only
//! what NumPy writes for plain arrays. The voxels come through a [`Stored`].

use std::io::Read as _;

use half::f16;
use npyz::{DType, Endianness, NpyHeader, Order, TypeChar, TypeStr};
use rayon::prelude::*;
use volgraph_volume::{Grid, ScalarType, Trouble, VolumeError, Voxels};

use crate::axes::Axes;
use crate::contents::{Components, Contents, Data, Opened};
use crate::input::{Input, stem};
use crate::load::{Limits, LoadOptions};
use crate::piece::{Encoding, Piece};
use crate::stream::{Job, Stored};

/// Longest header: NumPy itself reads no more than 10 000 bytes.
const LONGEST: usize = 10_000;

/// Whether a file with this head is an array of NumPy.
pub(crate) fn is_npy(head: &[u8]) -> bool {
    head.starts_with(b"\x93NUMPY")
}

/// Opens an array.
pub(crate) fn open<'a>(
    input: &Input<'a>,
    _options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let (bytes, text) = header(input)?;
    check_text(&text)?;
    let header = NpyHeader::from_reader(bytes.as_slice())
        .map_err(|error| syntax(format!("the header {text:?} cannot be read: {error}")))?;
    let DType::Plain(stored) = header.dtype() else {
        return Err(structured());
    };
    let (stored_type, half) = scalar_type(&stored)?;
    let axes = axes(header.shape(), header.order())?;
    let count = axes.count()?;
    let scalar_type = if half { ScalarType::F32 } else { stored_type };
    let mut contents = Contents::new(
        format!("NumPy {}.{}", bytes[6], bytes[7]),
        stem(&input.path),
        axes.clone(),
        scalar_type,
        Grid::axis_aligned(axes.dims(), glam::DVec3::ONE, glam::DVec3::ZERO),
    );
    // Bytes of three or four are colours far more often than vectors.
    if stored_type == ScalarType::U8 && (3..=4).contains(&axes.component_count()) {
        contents.components = Components::Colors;
    }
    let what = axes.describe(scalar_type);
    let stored = Stored {
        job: Job {
            pieces: vec![Piece {
                input: input.clone(),
                start: bytes.len() as u64,
                line_skip: 0,
                byte_skip: 0,
                encoding: Encoding::Raw,
                line_end: false,
                encoded_len: None,
            }],
            scalar_type: stored_type,
            big_endian: stored.endianness() == Endianness::Big,
            count,
            what,
        },
        axes,
        rescale: None,
    };
    let data: Box<dyn Data + 'a> = if half {
        Box::new(Halves(stored))
    } else {
        Box::new(stored)
    };
    Ok(Opened { contents, data })
}

/// All bytes before the voxels, and the text among them.
fn header(input: &Input<'_>) -> Result<(Vec<u8>, String), VolumeError> {
    let cut_off = || {
        VolumeError::DataTooShort(Trouble::new(
            "the file ends inside its header",
            "the file is cut off: fetch it again",
        ))
    };
    let start = input.head(12)?;
    let (length, from) = match *start.get(6..12).ok_or_else(cut_off)? {
        [1, 0, a, b, ..] => (usize::from(u16::from_le_bytes([a, b])), 10),
        [2 | 3, 0, a, b, c, d] => (u32::from_le_bytes([a, b, c, d]) as usize, 12),
        [major, minor, ..] => {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("version {major}.{minor} of the format is not known; 1.0 to 3.0 are"),
                "save the array again with numpy.save",
            )));
        }
        _ => return Err(cut_off()),
    };
    if length > LONGEST {
        return Err(syntax(format!(
            "the header has {length} bytes; {LONGEST} are the most"
        )));
    }
    let mut bytes = Vec::new();
    let mut reader = input.open(0)?.take((from + length) as u64);
    reader
        .read_to_end(&mut bytes)
        .map_err(|error| input.unreadable(&error))?;
    if bytes.len() < from + length {
        return Err(cut_off());
    }
    let text = String::from_utf8_lossy(&bytes[from..]).trim().to_owned();
    Ok((bytes, text))
}

/// Lets pass what NumPy writes for a plain array: one dictionary, one tuple of sizes whose product fits.
fn check_text(text: &str) -> Result<(), VolumeError> {
    if text.contains('[') {
        return Err(structured());
    }
    let unusual = || {
        syntax(format!(
            "the header {text:?} is not what NumPy writes for an array"
        ))
    };
    let count = |letter: char| text.matches(letter).count();
    if count('{') != 1 || count('(') != 1 || count(')') != 1 || text.contains('\\') {
        return Err(unusual());
    }
    let (before, after) = text.split_once('(').ok_or_else(unusual)?;
    let (sizes, after) = after.split_once(')').ok_or_else(unusual)?;
    let keyed = before.trim_end().strip_suffix(':').map(str::trim_end);
    let keyed =
        keyed.is_some_and(|before| before.ends_with("'shape'") || before.ends_with("\"shape\""));
    if !keyed || text.matches("shape").count() != 1 || after.contains('(') {
        return Err(unusual());
    }
    let sizes = sizes
        .split(',')
        .map(str::trim)
        .filter(|size| !size.is_empty());
    let mut product = 1_u64;
    for size in sizes {
        if !size.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(unusual());
        }
        let larger = size
            .parse::<u64>()
            .ok()
            .and_then(|size| product.checked_mul(size.max(1)));
        product = larger
            .filter(|&product| product <= i64::MAX as u64)
            .ok_or_else(|| {
                VolumeError::TooLarge(Trouble::new(
                    "the sizes of the array are more than 2^63 values".to_owned(),
                    "fetch the file again, or correct the shape in its header",
                ))
            })?;
    }
    Ok(())
}

fn syntax(cause: impl Into<String>) -> VolumeError {
    let cause = cause.into();
    let cause: String = cause.trim_end_matches('.').chars().take(300).collect();
    VolumeError::HeaderSyntax(Trouble::new(cause, "save the array again with numpy.save"))
}

fn structured() -> VolumeError {
    VolumeError::Unsupported(Trouble::new(
        "the array has fields (a structured type)",
        "save the field to look at as an array of its own",
    ))
}

/// The type of the stored numbers, and whether they are halves (stored as uint16 here).
fn scalar_type(stored: &TypeStr) -> Result<(ScalarType, bool), VolumeError> {
    use TypeChar::{Bool, Float, Int, Uint};
    let plain = |ty| Ok((ty, false));
    match (stored.type_char(), stored.size_field()) {
        (Bool | Uint, 1) => plain(ScalarType::U8),
        (Int, 1) => plain(ScalarType::I8),
        (Uint, 2) => plain(ScalarType::U16),
        (Int, 2) => plain(ScalarType::I16),
        (Uint, 4) => plain(ScalarType::U32),
        (Int, 4) => plain(ScalarType::I32),
        (Uint, 8) => plain(ScalarType::U64),
        (Int, 8) => plain(ScalarType::I64),
        (Float, 4) => plain(ScalarType::F32),
        (Float, 8) => plain(ScalarType::F64),
        (Float, 2) => Ok((ScalarType::U16, true)),
        (kind, _) => {
            let (what, remedy) = match kind {
                TypeChar::Object => (
                    "Python objects",
                    "save it as numbers: array.astype('float32')",
                ),
                TypeChar::Complex => ("complex numbers", "save its magnitude: numpy.abs(array)"),
                Float => ("long floats", "save it as float64: array.astype('float64')"),
                _ => ("no numbers", "save it as numbers"),
            };
            Err(VolumeError::Unsupported(Trouble::new(
                format!("the array holds {what} ({stored})"),
                remedy,
            )))
        }
    }
}

/// The last index is x, or the components of four axes.
fn axes(shape: &[u64], order: Order) -> Result<Axes, VolumeError> {
    let last = shape.last().copied().unwrap_or(0);
    let components = match shape.len() {
        1..=3 => 0,
        4 if (2..=4).contains(&last) => 1,
        4 if last == 1 => 1,
        n => {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("an array of {n} axes {shape:?} is no volume"),
                "save an array of one to three axes (z, y, x), or of four with two to four components on the last one",
            )));
        }
    };
    let spatial = shape.len() - components;
    Ok(match order {
        Order::C => Axes::new(
            shape.iter().rev().copied().collect(),
            (components..shape.len()).collect(),
        )?,
        Order::Fortran => Axes::new(shape.to_vec(), (0..spatial).rev().collect())?,
    })
}

/// Halves, read as uint16 and widened.
struct Halves<'a>(Stored<'a>);

impl Data for Halves<'_> {
    fn read(&self, step: u32, limits: &Limits) -> Result<Voxels, VolumeError> {
        let values = self.0.read(step, limits)?;
        let Voxels::U16(bits) = values else {
            return Ok(values);
        };
        let wide = bits.par_iter().map(|&bits| f16::from_bits(bits).to_f32());
        Ok(Voxels::F32(wide.collect()))
    }
}
