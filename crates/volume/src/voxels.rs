//! Voxels as typed, native-endian vectors, and the trait that the ten element types share.

use std::borrow::Cow;

use crate::ScalarType;

mod sealed {
    pub trait Sealed {}
}

/// One of the ten voxel types.
pub trait Element: bytemuck::Pod + PartialOrd + Send + Sync + sealed::Sealed {
    /// Its name as a value.
    const TYPE: ScalarType;
    /// The value as float64; 64-bit integers are rounded to the nearest float64.
    fn to_f64(self) -> f64;
    /// The value as float32, rounded where the type holds more digits.
    fn to_f32(self) -> f32;
    /// A field's value as a voxel: floats take it as it is; integers take `round(value * MAX)` of the value
    /// clamped to 0..1 (unsigned) or -1..1 (signed). Not-a-number becomes 0 in integers.
    fn from_field(value: f64) -> Self;
    /// With the order of its bytes turned round.
    #[must_use]
    fn swapped(self) -> Self;
    /// The value of a number written in text; `None` if it is none or does not fit the type.
    fn parse(token: &str) -> Option<Self>;
    /// A vector of them as [`Voxels`].
    fn wrap(values: Vec<Self>) -> Voxels;
}

macro_rules! elements {
    ($($type:ident $variant:ident $kind:ident,)*) => {
        /// All voxels of a volume, x fastest, then y, then z, in the machine's own byte order.
        #[derive(Clone, Debug, PartialEq)]
        #[expect(missing_docs, reason = "the names say it all")]
        pub enum Voxels {
            $($variant(Vec<$type>),)*
        }

        $(
            impl sealed::Sealed for $type {}

            impl Element for $type {
                const TYPE: ScalarType = ScalarType::$variant;

                fn to_f64(self) -> f64 {
                    self as f64
                }

                fn to_f32(self) -> f32 {
                    self as f32
                }

                fn from_field(value: f64) -> Self {
                    elements!(@from_field $kind $type value)
                }

                fn swapped(self) -> Self {
                    Self::from_ne_bytes({
                        let mut bytes = self.to_ne_bytes();
                        bytes.reverse();
                        bytes
                    })
                }

                fn parse(token: &str) -> Option<Self> {
                    elements!(@parse $kind $type token)
                }

                fn wrap(values: Vec<Self>) -> Voxels {
                    Voxels::$variant(values)
                }
            }

            impl From<Vec<$type>> for Voxels {
                fn from(values: Vec<$type>) -> Self {
                    Self::$variant(values)
                }
            }
        )*
    };
    (@from_field unsigned $type:ident $value:ident) => {
        ($value.clamp(0.0, 1.0) * $type::MAX as f64).round() as $type
    };
    (@from_field signed $type:ident $value:ident) => {
        ($value.clamp(-1.0, 1.0) * $type::MAX as f64).round() as $type
    };
    (@from_field float $type:ident $value:ident) => {
        $value as $type
    };
    (@parse float $type:ident $token:ident) => {
        $token.parse().ok()
    };
    (@parse $kind:ident $type:ident $token:ident) => {
        match $token.parse::<i128>() {
            Ok(value) => $type::try_from(value).ok(),
            // "3.0" and "1e3" are integers too; the range test keeps the cast exact.
            Err(_) => $token
                .parse::<f64>()
                .ok()
                .filter(|value| value.fract() == 0.0 && value.abs() < 9.0e15)
                .and_then(|value| $type::try_from(value as i64).ok()),
        }
    };
}

elements! {
    u8 U8 unsigned,
    i8 I8 signed,
    u16 U16 unsigned,
    i16 I16 signed,
    u32 U32 unsigned,
    i32 I32 signed,
    u64 U64 unsigned,
    i64 I64 signed,
    f32 F32 float,
    f64 F64 float,
}

/// Runs `$body` with `$slice` bound to the typed vector inside `$voxels`.
#[macro_export]
macro_rules! for_voxels {
    ($voxels:expr, $slice:ident => $body:expr) => {
        match $voxels {
            $crate::Voxels::U8($slice) => $body,
            $crate::Voxels::I8($slice) => $body,
            $crate::Voxels::U16($slice) => $body,
            $crate::Voxels::I16($slice) => $body,
            $crate::Voxels::U32($slice) => $body,
            $crate::Voxels::I32($slice) => $body,
            $crate::Voxels::U64($slice) => $body,
            $crate::Voxels::I64($slice) => $body,
            $crate::Voxels::F32($slice) => $body,
            $crate::Voxels::F64($slice) => $body,
        }
    };
}

/// Runs `$body` with `$type` naming the Rust type of the [`ScalarType`] value `$scalar`.
#[macro_export]
macro_rules! for_scalar_type {
    ($scalar:expr, $type:ident => $body:expr) => {
        match $scalar {
            $crate::ScalarType::U8 => {
                type $type = u8;
                $body
            }
            $crate::ScalarType::I8 => {
                type $type = i8;
                $body
            }
            $crate::ScalarType::U16 => {
                type $type = u16;
                $body
            }
            $crate::ScalarType::I16 => {
                type $type = i16;
                $body
            }
            $crate::ScalarType::U32 => {
                type $type = u32;
                $body
            }
            $crate::ScalarType::I32 => {
                type $type = i32;
                $body
            }
            $crate::ScalarType::U64 => {
                type $type = u64;
                $body
            }
            $crate::ScalarType::I64 => {
                type $type = i64;
                $body
            }
            $crate::ScalarType::F32 => {
                type $type = f32;
                $body
            }
            $crate::ScalarType::F64 => {
                type $type = f64;
                $body
            }
        }
    };
}

impl Voxels {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        for_voxels!(self, values => values.len())
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Their type.
    #[must_use]
    pub fn scalar_type(&self) -> ScalarType {
        fn of<T: Element>(_: &[T]) -> ScalarType {
            T::TYPE
        }
        for_voxels!(self, values => of(values))
    }

    /// Voxel `index` as float64.
    ///
    /// # Panics
    /// Where `index` is not below [`Voxels::len`], as a slice does.
    #[must_use]
    pub fn get(&self, index: usize) -> f64 {
        for_voxels!(self, values => values[index].to_f64())
    }

    /// The voxels as they lie in memory, in the machine's own byte order.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        for_voxels!(self, values => bytemuck::cast_slice(values))
    }

    /// All voxels as float32 (rounded where the type holds more digits); borrowed where they are float32.
    #[must_use]
    pub fn to_f32(&self) -> Cow<'_, [f32]> {
        match self {
            Self::F32(values) => Cow::Borrowed(values),
            _ => Cow::Owned(
                for_voxels!(self, values => values.iter().map(|value| value.to_f32()).collect()),
            ),
        }
    }

    /// Calls `visit` with every voxel as float64, in order.
    pub fn for_each(&self, mut visit: impl FnMut(f64)) {
        for_voxels!(self, values => values.iter().for_each(|value| visit(value.to_f64())));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_text_must_fit_their_type() {
        assert_eq!(u8::parse("255"), Some(255));
        assert_eq!(u8::parse("1e2"), Some(100));
        for bad in ["256", "-1", "1.5", "x", "", "nan"] {
            assert_eq!(u8::parse(bad), None, "{bad}");
        }
        assert_eq!(u64::parse("18446744073709551615"), Some(u64::MAX));
        assert_eq!(i64::parse("-9223372036854775808"), Some(i64::MIN));
        assert!(f32::parse("NaN").unwrap().is_nan());
    }

    #[test]
    fn a_field_value_becomes_a_rounded_fraction_of_the_largest_integer() {
        assert_eq!(u8::from_field(0.5), 128);
        assert_eq!(u8::from_field(7.0), 255);
        assert_eq!(u8::from_field(-7.0), 0);
        assert_eq!(i16::from_field(-7.0), -32767);
        assert_eq!(u64::from_field(1.0), u64::MAX);
        assert_eq!(u16::from_field(f64::NAN), 0);
        assert_eq!(f64::from_field(-7.25), -7.25);
    }

    #[test]
    fn bytes_turn_round() {
        assert_eq!(0x0102_u16.swapped(), 0x0201);
        assert_eq!(1.5_f64.swapped().swapped(), 1.5);
        assert_eq!(0x12_u8.swapped(), 0x12);
    }
}
