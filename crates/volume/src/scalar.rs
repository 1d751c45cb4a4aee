//! The ten voxel types and their many spellings.

use std::fmt;

/// The type of a voxel as it is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum ScalarType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl ScalarType {
    /// All ten.
    pub const ALL: [Self; 10] = [
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F32,
        Self::F64,
    ];

    /// The type of a name: `uint8`, `u8`, C's and NRRD's spellings (`unsigned char`, `short int`, `int16_t`,
    /// `longlong`), MetaImage's (`MET_UCHAR`). Case and the amount of white space do not matter.
    ///
    /// C's plain `long` is 4 or 8 bytes by machine and therefore unknown; MetaImage fixes `MET_LONG` at 4.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        let words: Vec<String> = name
            .split_whitespace()
            .map(str::to_ascii_lowercase)
            .collect();
        Some(match words.join(" ").as_str() {
            "uint8" | "u8" | "uint8_t" | "uchar" | "unsigned char" | "met_uchar" => Self::U8,
            "int8" | "i8" | "int8_t" | "char" | "signed char" | "met_char" => Self::I8,
            "uint16" | "u16" | "uint16_t" | "ushort" | "unsigned short" | "unsigned short int"
            | "met_ushort" => Self::U16,
            "int16" | "i16" | "int16_t" | "short" | "short int" | "signed short"
            | "signed short int" | "met_short" => Self::I16,
            "uint32" | "u32" | "uint32_t" | "uint" | "unsigned int" | "met_uint" | "met_ulong" => {
                Self::U32
            }
            "int32" | "i32" | "int32_t" | "int" | "signed int" | "met_int" | "met_long" => {
                Self::I32
            }
            "uint64"
            | "u64"
            | "uint64_t"
            | "ulonglong"
            | "unsigned long long"
            | "unsigned long long int"
            | "met_ulong_long" => Self::U64,
            "int64"
            | "i64"
            | "int64_t"
            | "longlong"
            | "long long"
            | "long long int"
            | "signed long long"
            | "signed long long int"
            | "met_long_long" => Self::I64,
            "float32" | "f32" | "float" | "met_float" => Self::F32,
            "float64" | "f64" | "double" | "met_double" => Self::F64,
            _ => return None,
        })
    }

    /// volgraph's own name: `uint8`, `int16`, `float32`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::U8 => "uint8",
            Self::I8 => "int8",
            Self::U16 => "uint16",
            Self::I16 => "int16",
            Self::U32 => "uint32",
            Self::I32 => "int32",
            Self::U64 => "uint64",
            Self::I64 => "int64",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }

    /// Bytes per voxel.
    #[must_use]
    pub fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Smallest and largest value of an integer type (64-bit ones rounded to float64); `None` for floats.
    #[must_use]
    pub fn range(self) -> Option<(f64, f64)> {
        Some(match self {
            Self::U8 => (0.0, f64::from(u8::MAX)),
            Self::I8 => (f64::from(i8::MIN), f64::from(i8::MAX)),
            Self::U16 => (0.0, f64::from(u16::MAX)),
            Self::I16 => (f64::from(i16::MIN), f64::from(i16::MAX)),
            Self::U32 => (0.0, f64::from(u32::MAX)),
            Self::I32 => (f64::from(i32::MIN), f64::from(i32::MAX)),
            Self::U64 => (0.0, u64::MAX as f64),
            Self::I64 => (i64::MIN as f64, i64::MAX as f64),
            Self::F32 | Self::F64 => return None,
        })
    }

    /// Whether it is a floating-point type.
    #[must_use]
    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }
}

impl fmt::Display for ScalarType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_knows_its_own_name_and_the_spellings_of_the_formats() {
        for ty in ScalarType::ALL {
            assert_eq!(ScalarType::parse(ty.name()), Some(ty));
        }
        for (name, ty) in [
            ("unsigned  Char", ScalarType::U8),
            ("signed short int", ScalarType::I16),
            ("MET_ULONG", ScalarType::U32),
            ("unsigned long long int", ScalarType::U64),
            ("double", ScalarType::F64),
        ] {
            assert_eq!(ScalarType::parse(name), Some(ty), "{name}");
        }
        for name in ["long", "uint9", "block", "", "MET_ARRAY", "unsigned"] {
            assert_eq!(ScalarType::parse(name), None, "{name}");
        }
    }
}
