//! The type of an array's elements by its names in both versions, and the value of those that are not there.

use serde_json::Value;
use volgraph_volume::{ScalarType, Trouble, VolumeError};

use super::metadata::bad;

/// The type of the elements in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stored {
    /// The type they are read as.
    pub scalar_type: ScalarType,
    /// Bytes of each in the file.
    pub size: usize,
}

impl Stored {
    fn of(scalar_type: ScalarType) -> Self {
        Self {
            scalar_type,
            size: scalar_type.size(),
        }
    }

    /// float16 becomes float32.
    pub fn is_half(self) -> bool {
        self.size != self.scalar_type.size()
    }
}

pub(super) fn unknown_type(name: &str) -> VolumeError {
    let name: String = name.chars().take(40).collect();
    VolumeError::UnknownType(Trouble::new(
        format!("the data type {name:?} is not read"),
        "save the array as booleans, integers of 8 to 64 bits or floats of 16 to 64 bits",
    ))
}

const HALF: Stored = Stored {
    scalar_type: ScalarType::F32,
    size: 2,
};

pub(super) fn type_of_v3(name: &str) -> Result<Stored, VolumeError> {
    match name {
        "bool" => Ok(Stored::of(ScalarType::U8)),
        "float16" => Ok(HALF),
        _ => {
            let ty = ScalarType::ALL.into_iter().find(|ty| ty.name() == name);
            ty.map(Stored::of).ok_or_else(|| unknown_type(name))
        }
    }
}

/// NumPy's type strings: byte order, kind, bytes.
pub(super) fn type_of_v2(name: &str) -> Result<(Stored, bool), VolumeError> {
    let big_endian = match name.get(..1) {
        Some("<" | "|") => false,
        Some(">") => true,
        _ => return Err(unknown_type(name)),
    };
    let stored = match &name[1..] {
        "b1" | "u1" => Stored::of(ScalarType::U8),
        "i1" => Stored::of(ScalarType::I8),
        "u2" => Stored::of(ScalarType::U16),
        "i2" => Stored::of(ScalarType::I16),
        "u4" => Stored::of(ScalarType::U32),
        "i4" => Stored::of(ScalarType::I32),
        "u8" => Stored::of(ScalarType::U64),
        "i8" => Stored::of(ScalarType::I64),
        "f2" => HALF,
        "f4" => Stored::of(ScalarType::F32),
        "f8" => Stored::of(ScalarType::F64),
        _ => return Err(unknown_type(name)),
    };
    Ok((stored, big_endian))
}

/// A fill value as one element; none is 0.
pub(super) fn fill_bytes(fill: &Value, element: Stored) -> Result<Vec<u8>, VolumeError> {
    let wrong = || {
        bad(format!(
            "the fill value {fill} does not fit {}",
            element.scalar_type
        ))
    };
    let hex = |text: &str| -> Option<Vec<u8>> {
        let number = u64::from_str_radix(text.strip_prefix("0x")?, 16).ok()?;
        Some(number.to_le_bytes()[..element.size].to_vec())
    };
    if let Some(mut bytes) = fill.as_str().and_then(hex) {
        if cfg!(target_endian = "big") {
            bytes.reverse();
        }
        return Ok(bytes);
    }
    if element.scalar_type.is_float() {
        let number = match fill {
            Value::Null => 0.0,
            Value::Number(number) => number.as_f64().ok_or_else(wrong)?,
            Value::String(text) => match text.as_str() {
                "NaN" => f64::NAN,
                "Infinity" => f64::INFINITY,
                "-Infinity" => f64::NEG_INFINITY,
                _ => return Err(wrong()),
            },
            _ => return Err(wrong()),
        };
        return Ok(match element.size {
            2 => half::f16::from_f64(number).to_ne_bytes().to_vec(),
            4 => (number as f32).to_ne_bytes().to_vec(),
            _ => number.to_ne_bytes().to_vec(),
        });
    }
    let number = match fill {
        Value::Null => 0,
        Value::Bool(value) => i128::from(*value),
        Value::Number(number) => match (number.as_i64(), number.as_u64(), number.as_f64()) {
            (Some(number), ..) => number.into(),
            (_, Some(number), _) => number.into(),
            // Version 2 writes 0.0 for integers too.
            (.., Some(number)) if number.fract() == 0.0 && number.abs() < 1e15 => number as i128,
            _ => return Err(wrong()),
        },
        _ => return Err(wrong()),
    };
    volgraph_volume::for_scalar_type!(element.scalar_type, T => {
        // Floats are done with: the cast is for the two arms that cannot be reached.
        if number < T::MIN as i128 || number > T::MAX as i128 {
            return Err(wrong());
        }
        Ok((number as T).to_ne_bytes().to_vec())
    })
}
