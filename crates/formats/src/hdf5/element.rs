//! The type of an array's elements, and how the crate gives them away.

use hdf5_reader::error::{ByteOrder, Error, Result};
use hdf5_reader::{Dataset, Datatype, H5Type};
use volgraph_volume::{Element, ScalarType, Trouble, VolumeError};

/// The type of the elements in the file.
#[derive(Clone, Debug)]
pub(super) struct Stored {
    /// The type they become.
    pub scalar_type: ScalarType,
    /// Bytes of each in the file.
    pub size: usize,
    /// float16, which becomes float32.
    pub is_half: bool,
    pub big_endian: bool,
}

impl Stored {
    /// The number as elements hold it: a mark may be written with more digits than they have.
    pub fn nearest(&self, number: f64) -> f64 {
        match self.scalar_type {
            _ if self.is_half => half::f16::from_f64(number).to_f64(),
            ScalarType::F32 => f64::from(number as f32),
            _ => number,
        }
    }

    pub fn is_byte(&self) -> bool {
        self.scalar_type == ScalarType::U8
    }
}

/// Numbers that are read here; whole bytes all of them.
pub(super) fn of(dataset: &Dataset) -> std::result::Result<Stored, VolumeError> {
    let unknown = |what: &str, remedy: &str| {
        Err(VolumeError::UnknownType(Trouble::new(
            format!(
                "the array {:?} holds {what}",
                crate::choice::cut(dataset.name())
            ),
            remedy,
        )))
    };
    let (scalar_type, big_endian) = match dataset.dtype() {
        Datatype::Compound { .. } => {
            return unknown(
                "structures",
                "save the field to look at as an array of its own",
            );
        }
        other => match scalar(other) {
            Some(known) => known,
            None => return unknown("no numbers that are read here", REMEDY),
        },
    };
    let is_half = scalar_type.is_none();
    let scalar_type = scalar_type.unwrap_or(ScalarType::F32);
    let size = if is_half { 2 } else { scalar_type.size() };
    let description = dataset
        .raw_datatype()
        .map_err(|error| super::told(&error))?;
    if !is_usual(dataset.dtype(), &description, scalar_type, size) {
        return unknown(
            "numbers of an unusual layout (bits left out, or another kind of float)",
            REMEDY,
        );
    }
    Ok(Stored {
        scalar_type,
        size,
        is_half,
        big_endian,
    })
}

const REMEDY: &str = "save it as integers of 8 to 64 bits or floats of 16 to 64 bits";

/// Whether voxels can be of this type; `None` in it for halves.
pub(super) fn scalar(dtype: &Datatype) -> Option<(Option<ScalarType>, bool)> {
    Some(match *dtype {
        Datatype::FixedPoint {
            size,
            signed,
            byte_order,
        } => {
            let ty = match (size, signed) {
                (1, false) => ScalarType::U8,
                (1, true) => ScalarType::I8,
                (2, false) => ScalarType::U16,
                (2, true) => ScalarType::I16,
                (4, false) => ScalarType::U32,
                (4, true) => ScalarType::I32,
                (8, false) => ScalarType::U64,
                (8, true) => ScalarType::I64,
                _ => return None,
            };
            (Some(ty), byte_order == ByteOrder::BigEndian)
        }
        Datatype::FloatingPoint { size, byte_order } => {
            let ty = match size {
                2 => None,
                4 => Some(ScalarType::F32),
                8 => Some(ScalarType::F64),
                _ => return None,
            };
            (ty, byte_order == ByteOrder::BigEndian)
        }
        // Booleans of h5py, and names for numbers.
        Datatype::Enum { ref base, .. } => match scalar(base)? {
            (Some(ScalarType::I8), order) => (Some(ScalarType::U8), order),
            other => other,
        },
        _ => return None,
    })
}

/// Whether the description has all bits where IEEE and two's complement have them: the crate does not look.
/// A class, three bytes of flags, the size, and then for integers offset and precision, 16 bits each; for floats
/// places and sizes of exponent and mantissa behind them.
fn is_usual(dtype: &Datatype, description: &[u8], ty: ScalarType, size: usize) -> bool {
    let description = match dtype {
        // The type that has the names.
        Datatype::Enum { .. } => description.get(8..),
        _ => Some(description),
    };
    let Some(
        &[
            _,
            flags,
            _,
            _,
            _,
            _,
            _,
            _,
            offset,
            offset_high,
            bits,
            bits_high,
            ref rest @ ..,
        ],
    ) = description
    else {
        return false;
    };
    let whole = u16::from_le_bytes([offset, offset_high]) == 0
        && usize::from(u16::from_le_bytes([bits, bits_high])) == 8 * size;
    let float: &[u8] = match (ty.is_float(), size) {
        (false, _) => return whole,
        (true, 2) => &[10, 5, 0, 10, 15, 0, 0, 0],
        (true, 4) => &[23, 8, 0, 23, 127, 0, 0, 0],
        (true, _) => &[52, 11, 0, 52, 255, 3, 0, 0],
    };
    // The order of VAX has bit 6.
    whole && flags & 0x40 == 0 && rest.starts_with(float)
}

/// An element as its bytes make it, whatever the crate thinks of its type.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct Bits<T>(pub T);

impl<T: Element> H5Type for Bits<T> {
    fn hdf5_type() -> Datatype {
        Datatype::Opaque {
            size: size_of::<T>() as u32,
            tag: String::new(),
        }
    }

    fn from_bytes(bytes: &[u8], dtype: &Datatype) -> Result<Self> {
        let bytes = bytes.get(..size_of::<T>());
        let bytes = bytes.ok_or_else(|| Error::InvalidData("an element is cut off".into()))?;
        let value = bytemuck::pod_read_unaligned::<T>(bytes);
        Ok(Self(if is_swapped(dtype) {
            value.swapped()
        } else {
            value
        }))
    }

    fn element_size(_dtype: &Datatype) -> usize {
        size_of::<T>()
    }

    fn decode_vec(raw: &[u8], dtype: &Datatype, count: usize) -> Option<Result<Vec<Self>>> {
        let raw = raw.get(..count.checked_mul(size_of::<T>())?)?;
        let swapped = is_swapped(dtype);
        let values = raw.chunks_exact(size_of::<T>()).map(|bytes| {
            let value = bytemuck::pod_read_unaligned::<T>(bytes);
            Self(if swapped { value.swapped() } else { value })
        });
        Some(Ok(values.collect()))
    }

    fn native_copy_compatible(dtype: &Datatype) -> bool {
        // The crate copies bytes onto elements then: any bits make one, and the sizes are the same.
        let size = scalar(dtype).map(|(ty, _)| ty.map_or(2, ScalarType::size));
        size == Some(size_of::<T>()) && !is_swapped(dtype)
    }
}

fn is_swapped(dtype: &Datatype) -> bool {
    scalar(dtype).is_some_and(|(_, big)| big != cfg!(target_endian = "big"))
}

/// Any number, as attributes and coordinates have them.
#[derive(Clone, Copy)]
pub(super) struct Number(pub f64);

impl H5Type for Number {
    fn hdf5_type() -> Datatype {
        f64::hdf5_type()
    }

    fn from_bytes(bytes: &[u8], dtype: &Datatype) -> Result<Self> {
        let mismatch = || Error::InvalidData("no number".into());
        let (ty, _) = scalar(dtype).ok_or_else(mismatch)?;
        let Some(ty) = ty else {
            let Bits(bits) = Bits::<u16>::from_bytes(bytes, dtype)?;
            return Ok(Self(half::f16::from_bits(bits).to_f64()));
        };
        volgraph_volume::for_scalar_type!(ty, T => {
            Bits::<T>::from_bytes(bytes, dtype).map(|Bits(value)| Self(value.to_f64()))
        })
    }

    fn element_size(dtype: &Datatype) -> usize {
        scalar(dtype).map_or(0, |(ty, _)| ty.map_or(2, ScalarType::size))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_compared_as_elements_hold_them() {
        let stored = |scalar_type, is_half| Stored {
            scalar_type,
            size: 4,
            is_half,
            big_endian: false,
        };
        let single = stored(ScalarType::F32, false);
        assert_eq!(
            single.nearest(1e20).to_bits(),
            f64::from(1e20_f32).to_bits()
        );
        assert_eq!(
            stored(ScalarType::F64, false).nearest(1e20).to_bits(),
            1e20_f64.to_bits()
        );
        assert_eq!(
            stored(ScalarType::F32, true).nearest(0.1).to_bits(),
            0.099_975_585_937_5_f64.to_bits()
        );
        assert_eq!(
            stored(ScalarType::I16, false).nearest(-999.0).to_bits(),
            (-999.0_f64).to_bits()
        );
    }
}
