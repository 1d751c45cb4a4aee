//! What the file says: the image, its pieces, their arrays and the places of the voxels.

use glam::{DMat3, DVec3};
use volgraph_volume::{ScalarType, Trouble, VolumeError};

/// First and last point along each axis.
pub(super) type Extent = [[i32; 2]; 3];

/// What the file says.
#[derive(Debug, Default)]
pub(super) struct Header {
    pub version: String,
    pub extent: Extent,
    pub origin: DVec3,
    pub spacing: DVec3,
    pub direction: DMat3,
    pub coding: Coding,
    pub pieces: Vec<Piece>,
    /// The file's `TimeValue`, as it is written.
    pub time: Option<String>,
    pub warnings: Vec<String>,
}

/// How the bytes of all arrays are written down.
#[derive(Clone, Debug, Default)]
pub(super) struct Coding {
    pub big_endian: bool,
    /// Lengths before the bytes have 64 bits instead of 32.
    pub wide: bool,
    pub compressor: Compressor,
    /// Where the appended bytes begin, and whether they are base64.
    pub appended: Option<(u64, bool)>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Compressor {
    #[default]
    None,
    Zlib,
    Lz4,
    /// In the container of xz.
    Lzma,
}

/// What values belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum On {
    Points,
    Cells,
}

/// A box of the extent.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub extent: Extent,
    pub arrays: Vec<(On, Array)>,
    /// Names of the arrays that are active at points and in cells.
    pub active: [Option<String>; 2],
}

/// An array, not yet checked.
#[derive(Clone, Debug)]
pub(super) struct Array {
    pub name: String,
    pub kind: String,
    pub components: String,
    pub place: Place,
}

/// Where the values of an array are.
#[derive(Clone, Debug)]
pub(super) enum Place {
    /// Numbers as text.
    Text { from: u64, len: u64 },
    /// Base64 between the tags.
    Inline { from: u64, len: u64 },
    /// From this byte (or letter) of the appended data on.
    Appended { offset: u64 },
}

impl On {
    /// Samples along each axis of an extent; a flat axis has one cell.
    pub fn dims(self, extent: Extent) -> Result<[u32; 3], VolumeError> {
        let mut dims = [0; 3];
        for (dim, [from, to]) in dims.iter_mut().zip(extent) {
            let cells = i64::from(to) - i64::from(from);
            let samples = match self {
                Self::Points => cells + 1,
                Self::Cells => {
                    if cells == 0 {
                        1
                    } else {
                        cells
                    }
                }
            };
            let fits = u32::try_from(samples).ok().filter(|&samples| samples > 0);
            *dim = fits.ok_or_else(|| {
                VolumeError::Grid(Trouble::new(
                    format!("the extent {from} to {to} has no samples, or too many"),
                    "correct WholeExtent or Extent: first and last point of each axis",
                ))
            })?;
        }
        Ok(dims)
    }
}

impl Header {
    /// Names of the arrays of the first piece.
    pub fn names(&self) -> impl Iterator<Item = (On, &str)> {
        let arrays = self.pieces.first().map_or(&[][..], |piece| &piece.arrays);
        arrays.iter().map(|(on, array)| (*on, array.name.as_str()))
    }

    pub fn active(&self, on: On) -> Option<&str> {
        let piece = self.pieces.first()?;
        piece.active[usize::from(on == On::Cells)].as_deref()
    }

    pub fn array(&self, piece: usize, on: On, name: &str) -> Option<&Array> {
        let arrays = &self.pieces.get(piece)?.arrays;
        let found = arrays
            .iter()
            .find(|(at, array)| *at == on && array.name == name);
        found.map(|(_, array)| array)
    }
}

impl Array {
    pub fn scalar_type(&self) -> Result<ScalarType, VolumeError> {
        Ok(match self.kind.as_str() {
            "Int8" => ScalarType::I8,
            "UInt8" => ScalarType::U8,
            "Int16" => ScalarType::I16,
            "UInt16" => ScalarType::U16,
            "Int32" => ScalarType::I32,
            "UInt32" => ScalarType::U32,
            "Int64" => ScalarType::I64,
            "UInt64" => ScalarType::U64,
            "Float32" => ScalarType::F32,
            "Float64" => ScalarType::F64,
            other => {
                return Err(VolumeError::UnknownType(Trouble::new(
                    format!("the array {:?} is of type {other:?}", self.name),
                    "save it as one of Int8 to UInt64, Float32 and Float64",
                )));
            }
        })
    }

    /// Values per sample.
    pub fn components(&self) -> Result<u64, VolumeError> {
        let count = self.components.parse::<u32>().ok();
        count
            .filter(|&count| count > 0)
            .map(u64::from)
            .ok_or_else(|| {
                bad(
                    format!(
                        "the array {:?} has {:?} components",
                        self.name, self.components
                    ),
                    "correct NumberOfComponents",
                )
            })
    }
}

pub(super) fn bad(cause: String, remedy: &str) -> VolumeError {
    VolumeError::BadValue(Trouble::new(cause, remedy))
}
