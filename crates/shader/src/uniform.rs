//! Fills a uniform buffer by the names of its members.

use std::fmt;

use volgraph_report::{did_you_mean, list_names};

use crate::layout::{MemberType, ScalarType, StructLayout};
use crate::params::{ParamSpec, ParamValue};

/// A value for a member. Matrices are columns.
#[derive(Clone, Debug, PartialEq)]
pub enum UniformValue {
    /// `f32`
    F32(f32),
    /// `i32`
    I32(i32),
    /// `u32`
    U32(u32),
    /// `vec2f`
    Vec2([f32; 2]),
    /// `vec3f`
    Vec3([f32; 3]),
    /// `vec4f`
    Vec4([f32; 4]),
    /// `vec2i`
    IVec2([i32; 2]),
    /// `vec3i`
    IVec3([i32; 3]),
    /// `vec4i`
    IVec4([i32; 4]),
    /// `vec2u`
    UVec2([u32; 2]),
    /// `vec3u`
    UVec3([u32; 3]),
    /// `vec4u`
    UVec4([u32; 4]),
    /// `mat3x3f`
    Mat3([[f32; 3]; 3]),
    /// `mat4x4f`
    Mat4([[f32; 4]; 4]),
    /// `array<T, N>`, all `N` elements
    Array(Vec<UniformValue>),
    /// A struct in the struct: name and value of each member, in any order
    Struct(Vec<(String, UniformValue)>),
}

/// Why a uniform cannot be filled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UniformError {
    /// No such member.
    #[error("`{layout}` has no member `{member}`{help}")]
    UnknownMember {
        /// The struct.
        layout: String,
        /// The name asked for.
        member: String,
        /// Names like it, after a semicolon; or nothing.
        help: String,
    },
    /// A value of another type.
    #[error("`{layout}.{member}` is {expected}, not {given}")]
    WrongType {
        /// The struct.
        layout: String,
        /// The member.
        member: String,
        /// The member's type.
        expected: String,
        /// The value's.
        given: String,
    },
    /// Members that no one set.
    #[error("`{layout}` is not filled, these are not set: {members}")]
    Missing {
        /// The struct.
        layout: String,
        /// The members, as a list.
        members: String,
    },
}

/// Fills the bytes of one uniform struct, little-endian; what lies between members is zero.
#[derive(Clone, Debug)]
pub struct UniformWriter<'l> {
    layout: &'l StructLayout,
    bytes: Vec<u8>,
    is_set: Vec<bool>,
}

impl<'l> UniformWriter<'l> {
    /// All members unset.
    #[must_use]
    pub fn new(layout: &'l StructLayout) -> Self {
        Self {
            layout,
            bytes: vec![0; layout.size as usize],
            is_set: vec![false; layout.members.len()],
        }
    }

    /// Whether the struct has this member; a shader may declare fewer than there are.
    #[must_use]
    pub fn has(&self, member: &str) -> bool {
        self.layout.member(member).is_some()
    }

    /// Sets a member; again, to set it anew.
    ///
    /// # Errors
    /// [`UniformError::UnknownMember`], [`UniformError::WrongType`]; nothing is written then.
    pub fn set(
        &mut self,
        member: &str,
        value: impl Into<UniformValue>,
    ) -> Result<&mut Self, UniformError> {
        let layout = self.layout;
        let Some(at) = layout.members.iter().position(|known| known.name == member) else {
            let names = layout.members.iter().map(|member| member.name.as_str());
            return Err(UniformError::UnknownMember {
                layout: layout.name.clone(),
                member: member.to_owned(),
                help: did_you_mean(member, names)
                    .map(|help| format!("; {help}"))
                    .unwrap_or_default(),
            });
        };
        let value = value.into();
        let (offset, ty) = (layout.members[at].offset, &layout.members[at].ty);
        if !fits(ty, &value) {
            return Err(UniformError::WrongType {
                layout: layout.name.clone(),
                member: member.to_owned(),
                expected: ty.to_string(),
                given: value.to_string(),
            });
        }
        write(&mut self.bytes, offset as usize, ty, &value);
        self.is_set[at] = true;
        Ok(self)
    }

    /// Sets the member of a parameter's name to its value.
    ///
    /// # Errors
    /// As [`Self::set`]; `WrongType` also where [`ParamSpec::check`] refuses the value.
    pub fn set_param(
        &mut self,
        spec: &ParamSpec,
        value: &ParamValue,
    ) -> Result<&mut Self, UniformError> {
        let ty = self.layout.member(&spec.name).map(|member| &member.ty);
        let value_for = |ty: &MemberType| {
            let value = spec
                .check(value)
                .map_err(|why| format!("`{value}`: {why}"))?;
            from_param(spec, &value, ty).ok_or_else(|| format!("the parameter value `{value}`"))
        };
        match ty.map(|ty| value_for(ty).map_err(|given| (ty, given))) {
            // An unknown member: `set` says so.
            None => self.set(&spec.name, 0.0_f32),
            Some(Ok(value)) => self.set(&spec.name, value),
            Some(Err((ty, given))) => Err(UniformError::WrongType {
                layout: self.layout.name.clone(),
                member: spec.name.clone(),
                expected: ty.to_string(),
                given,
            }),
        }
    }

    /// The bytes; as many as the struct's size.
    ///
    /// # Errors
    /// [`UniformError::Missing`] with all members never set.
    pub fn finish(self) -> Result<Vec<u8>, UniformError> {
        let members = self.layout.members.iter().zip(&self.is_set);
        let missing: Vec<&str> = members
            .filter(|(_, is_set)| !**is_set)
            .map(|(member, _)| member.name.as_str())
            .collect();
        if missing.is_empty() {
            return Ok(self.bytes);
        }
        Err(UniformError::Missing {
            layout: self.layout.name.clone(),
            members: list_names(missing),
        })
    }
}

/// A checked parameter value in the type of its member.
fn from_param(spec: &ParamSpec, value: &ParamValue, ty: &MemberType) -> Option<UniformValue> {
    use ScalarType::{F32, I32, U32};
    // Checked values are whole and in the bounds of their type: `as` loses nothing but f32's rounding.
    let number = match value {
        ParamValue::Int(number) => *number as f64,
        ParamValue::Float(number) => *number,
        ParamValue::Bool(is) => f64::from(u8::from(*is)),
        ParamValue::Text(choice) => spec.choice_index(choice)? as f64,
        ParamValue::Vector(numbers) => {
            return Some(match (ty, numbers.as_slice()) {
                (MemberType::Vector(F32, 2), &[x, y]) => [x as f32, y as f32].into(),
                (MemberType::Vector(F32, 3), &[x, y, z]) => [x as f32, y as f32, z as f32].into(),
                (MemberType::Vector(F32, 4), &[x, y, z, w]) => {
                    [x as f32, y as f32, z as f32, w as f32].into()
                }
                (MemberType::Vector(I32, 2), &[x, y]) => [x as i32, y as i32].into(),
                (MemberType::Vector(I32, 3), &[x, y, z]) => [x as i32, y as i32, z as i32].into(),
                (MemberType::Vector(I32, 4), &[x, y, z, w]) => {
                    [x as i32, y as i32, z as i32, w as i32].into()
                }
                (MemberType::Vector(U32, 2), &[x, y]) => [x as u32, y as u32].into(),
                (MemberType::Vector(U32, 3), &[x, y, z]) => [x as u32, y as u32, z as u32].into(),
                (MemberType::Vector(U32, 4), &[x, y, z, w]) => {
                    [x as u32, y as u32, z as u32, w as u32].into()
                }
                _ => return None,
            });
        }
    };
    let is_whole = number.fract() == 0.0;
    match ty {
        MemberType::Scalar(F32) => Some((number as f32).into()),
        MemberType::Scalar(I32) if is_whole && number.abs() <= f64::from(i32::MAX) => {
            Some((number as i32).into())
        }
        MemberType::Scalar(U32) if is_whole && (0.0..=f64::from(u32::MAX)).contains(&number) => {
            Some((number as u32).into())
        }
        _ => None,
    }
}

fn fits(ty: &MemberType, value: &UniformValue) -> bool {
    match (ty, value) {
        (
            MemberType::Array {
                element,
                count: Some(count),
                ..
            },
            UniformValue::Array(values),
        ) => values.len() == *count as usize && values.iter().all(|value| fits(element, value)),
        (MemberType::Struct(layout), UniformValue::Struct(values)) => {
            let has_one =
                |name: &str| values.iter().filter(|(given, _)| given == name).count() == 1;
            values.len() == layout.members.len()
                && layout.members.iter().all(|member| has_one(&member.name))
                && values.iter().all(|(name, value)| {
                    layout
                        .member(name)
                        .is_some_and(|member| fits(&member.ty, value))
                })
        }
        (MemberType::Array { .. } | MemberType::Struct(_), _) => false,
        (_, UniformValue::Array(_) | UniformValue::Struct(_)) => false,
        (ty, value) => value.ty().is_some_and(|given| given == *ty),
    }
}

/// Writes a value that fits at `offset`.
fn write(bytes: &mut [u8], offset: usize, ty: &MemberType, value: &UniformValue) {
    match (ty, value) {
        (
            MemberType::Array {
                element, stride, ..
            },
            UniformValue::Array(values),
        ) => {
            for (at, value) in values.iter().enumerate() {
                write(bytes, offset + at * *stride as usize, element, value);
            }
        }
        (MemberType::Struct(layout), UniformValue::Struct(values)) => {
            for (name, value) in values {
                if let Some(member) = layout.member(name) {
                    write(bytes, offset + member.offset as usize, &member.ty, value);
                }
            }
        }
        // A column of three takes the room of four (WGSL 14.4.1).
        (_, UniformValue::Mat3(columns)) => {
            for (at, column) in columns.iter().enumerate() {
                put(bytes, offset + 16 * at, &column.map(f32::to_le_bytes));
            }
        }
        (_, UniformValue::Mat4(columns)) => {
            let columns = columns.map(|column| column.map(f32::to_le_bytes));
            put(bytes, offset, columns.as_flattened());
        }
        (_, value) => put(bytes, offset, &value.words()),
    }
}

fn put(bytes: &mut [u8], offset: usize, words: &[[u8; 4]]) {
    let value = words.as_flattened();
    if let Some(room) = bytes.get_mut(offset..offset + value.len()) {
        room.copy_from_slice(value);
    }
}

impl UniformValue {
    /// The bytes of a scalar or vector; nothing for others.
    fn words(&self) -> Vec<[u8; 4]> {
        match self {
            Self::F32(number) => vec![number.to_le_bytes()],
            Self::I32(number) => vec![number.to_le_bytes()],
            Self::U32(number) => vec![number.to_le_bytes()],
            Self::Vec2(numbers) => numbers.map(f32::to_le_bytes).to_vec(),
            Self::Vec3(numbers) => numbers.map(f32::to_le_bytes).to_vec(),
            Self::Vec4(numbers) => numbers.map(f32::to_le_bytes).to_vec(),
            Self::IVec2(numbers) => numbers.map(i32::to_le_bytes).to_vec(),
            Self::IVec3(numbers) => numbers.map(i32::to_le_bytes).to_vec(),
            Self::IVec4(numbers) => numbers.map(i32::to_le_bytes).to_vec(),
            Self::UVec2(numbers) => numbers.map(u32::to_le_bytes).to_vec(),
            Self::UVec3(numbers) => numbers.map(u32::to_le_bytes).to_vec(),
            Self::UVec4(numbers) => numbers.map(u32::to_le_bytes).to_vec(),
            Self::Mat3(_) | Self::Mat4(_) | Self::Array(_) | Self::Struct(_) => Vec::new(),
        }
    }

    /// Its WGSL type; `None` for what has no one type.
    fn ty(&self) -> Option<MemberType> {
        use ScalarType::{F32, I32, U32};
        Some(match self {
            Self::F32(_) => MemberType::Scalar(F32),
            Self::I32(_) => MemberType::Scalar(I32),
            Self::U32(_) => MemberType::Scalar(U32),
            Self::Vec2(_) => MemberType::Vector(F32, 2),
            Self::Vec3(_) => MemberType::Vector(F32, 3),
            Self::Vec4(_) => MemberType::Vector(F32, 4),
            Self::IVec2(_) => MemberType::Vector(I32, 2),
            Self::IVec3(_) => MemberType::Vector(I32, 3),
            Self::IVec4(_) => MemberType::Vector(I32, 4),
            Self::UVec2(_) => MemberType::Vector(U32, 2),
            Self::UVec3(_) => MemberType::Vector(U32, 3),
            Self::UVec4(_) => MemberType::Vector(U32, 4),
            Self::Mat3(_) => MemberType::Matrix {
                columns: 3,
                rows: 3,
                scalar: F32,
            },
            Self::Mat4(_) => MemberType::Matrix {
                columns: 4,
                rows: 4,
                scalar: F32,
            },
            Self::Array(_) | Self::Struct(_) => return None,
        })
    }
}

impl fmt::Display for UniformValue {
    /// Its type, for messages.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self, self.ty()) {
            (_, Some(ty)) => write!(f, "{ty}"),
            (Self::Array(values), _) => match values.first() {
                Some(value) => write!(f, "array<{value}, {}>", values.len()),
                None => f.write_str("an empty array"),
            },
            (Self::Struct(members), _) => {
                let names = list_names(members.iter().map(|(name, _)| name.as_str()));
                write!(f, "a struct of {names}")
            }
            // All others have a type.
            _ => Ok(()),
        }
    }
}

macro_rules! from {
    ($($ty:ty => $variant:ident),* $(,)?) => {
        $(impl From<$ty> for UniformValue {
            fn from(value: $ty) -> Self {
                Self::$variant(value)
            }
        })*
    };
}

from! {
    f32 => F32, i32 => I32, u32 => U32,
    [f32; 2] => Vec2, [f32; 3] => Vec3, [f32; 4] => Vec4,
    [i32; 2] => IVec2, [i32; 3] => IVec3, [i32; 4] => IVec4,
    [u32; 2] => UVec2, [u32; 3] => UVec3, [u32; 4] => UVec4,
    [[f32; 3]; 3] => Mat3, [[f32; 4]; 4] => Mat4,
}
