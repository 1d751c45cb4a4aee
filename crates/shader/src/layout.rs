//! The memory layout of WGSL structs, as naga lays them out.

use std::fmt;

use naga::{ArraySize, Handle, Scalar, ScalarKind, Type, TypeInner};
use volgraph_report::Place;

use crate::Linked;

/// A number type of WGSL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScalarType {
    /// `f32`
    F32,
    /// `f16`
    F16,
    /// `i32`
    I32,
    /// `u32`
    U32,
}

/// The type of a struct's member.
#[derive(Clone, Debug, PartialEq)]
pub enum MemberType {
    /// One number.
    Scalar(ScalarType),
    /// 2, 3 or 4 numbers.
    Vector(ScalarType, u32),
    /// Columns × rows, stored by columns; a column of three numbers takes the room of four.
    Matrix {
        /// How many columns.
        columns: u32,
        /// How many rows.
        rows: u32,
        /// What numbers.
        scalar: ScalarType,
    },
    /// An array.
    Array {
        /// The type of an element.
        element: Box<MemberType>,
        /// How many; `None` where the buffer's size or an override decides.
        count: Option<u32>,
        /// Bytes from one element to the next.
        stride: u32,
    },
    /// A struct in the struct.
    Struct(StructLayout),
    /// An atomic number.
    Atomic(ScalarType),
    /// What no buffer of ours holds; its WGSL name.
    Other(String),
}

/// One member of a struct.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Its name.
    pub name: String,
    /// Bytes from the start of the struct.
    pub offset: u32,
    /// Bytes.
    pub size: u32,
    /// Its type.
    pub ty: MemberType,
    /// Where it is declared.
    pub place: Place,
}

/// A struct's layout.
#[derive(Clone, Debug, PartialEq)]
pub struct StructLayout {
    /// The struct's name; a uniform that is no struct has its variable's name, and one member of that name.
    pub name: String,
    /// Bytes, rounded up to the alignment; a run-time array counts as one element.
    pub size: u32,
    /// In the order of declaration.
    pub members: Vec<Member>,
}

impl StructLayout {
    /// The member of this name.
    #[must_use]
    pub fn member(&self, name: &str) -> Option<&Member> {
        self.members.iter().find(|member| member.name == name)
    }
}

impl fmt::Display for ScalarType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::F32 => "f32",
            Self::F16 => "f16",
            Self::I32 => "i32",
            Self::U32 => "u32",
        })
    }
}

impl fmt::Display for MemberType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scalar(scalar) => write!(f, "{scalar}"),
            Self::Vector(scalar, size) => write!(f, "vec{size}<{scalar}>"),
            Self::Matrix {
                columns,
                rows,
                scalar,
            } => write!(f, "mat{columns}x{rows}<{scalar}>"),
            Self::Array {
                element,
                count: Some(count),
                ..
            } => write!(f, "array<{element}, {count}>"),
            Self::Array {
                element,
                count: None,
                ..
            } => write!(f, "array<{element}>"),
            Self::Struct(layout) => f.write_str(&layout.name),
            Self::Atomic(scalar) => write!(f, "atomic<{scalar}>"),
            Self::Other(name) => f.write_str(name),
        }
    }
}

/// The number type of naga's, where a buffer can hold it.
pub(crate) fn scalar_type(scalar: Scalar) -> Option<ScalarType> {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) => Some(ScalarType::F32),
        (ScalarKind::Float, 2) => Some(ScalarType::F16),
        (ScalarKind::Sint, 4) => Some(ScalarType::I32),
        (ScalarKind::Uint, 4) => Some(ScalarType::U32),
        _ => None,
    }
}

/// How many members a layout lists in all; small structs inside each other can have more than memory.
const MAX_MEMBERS: usize = 4096;

/// How deep types nest: WGSL's limit (section 15.1, limits), which naga does not enforce.
const MAX_DEPTH: usize = 15;

/// Reads layouts from a module.
pub(crate) struct Layouts<'a> {
    module: &'a naga::Module,
    linked: &'a Linked,
    members_left: usize,
    depth: usize,
}

impl<'a> Layouts<'a> {
    pub fn new(module: &'a naga::Module, linked: &'a Linked) -> Self {
        Self {
            module,
            linked,
            members_left: MAX_MEMBERS,
            depth: 0,
        }
    }

    /// A type as a member's; what is too large to list is `Other`.
    pub fn member_type(&mut self, ty: Handle<Type>) -> MemberType {
        let ty = &self.module.types[ty];
        if self.depth >= MAX_DEPTH {
            return MemberType::Other(other_name(ty));
        }
        self.depth += 1;
        let known = match &ty.inner {
            TypeInner::Scalar(scalar) => scalar_type(*scalar).map(MemberType::Scalar),
            TypeInner::Vector { size, scalar } => {
                scalar_type(*scalar).map(|scalar| MemberType::Vector(scalar, *size as u32))
            }
            TypeInner::Matrix {
                columns,
                rows,
                scalar,
            } => scalar_type(*scalar).map(|scalar| MemberType::Matrix {
                columns: *columns as u32,
                rows: *rows as u32,
                scalar,
            }),
            TypeInner::Atomic(scalar) => scalar_type(*scalar).map(MemberType::Atomic),
            TypeInner::Array { base, size, stride } => Some(MemberType::Array {
                element: Box::new(self.member_type(*base)),
                count: match size {
                    ArraySize::Constant(count) => Some(count.get()),
                    ArraySize::Pending(_) | ArraySize::Dynamic => None,
                },
                stride: *stride,
            }),
            TypeInner::Struct { .. } => self.struct_layout(ty).map(MemberType::Struct),
            _ => None,
        };
        self.depth -= 1;
        known.unwrap_or_else(|| MemberType::Other(other_name(ty)))
    }

    /// The layout of a type that is a struct, and not too large to list.
    pub fn struct_layout(&mut self, ty: &Type) -> Option<StructLayout> {
        let TypeInner::Struct { members, span } = &ty.inner else {
            return None;
        };
        self.members_left = self.members_left.checked_sub(members.len())?;
        let name = ty.name.clone().unwrap_or_default();
        let members = members
            .iter()
            .map(|member| {
                let member_name = member.name.clone().unwrap_or_default();
                Member {
                    offset: member.offset,
                    size: self.size_of(member.ty),
                    ty: self.member_type(member.ty),
                    place: self.linked.member_place(&name, &member_name),
                    name: member_name,
                }
            })
            .collect();
        Some(StructLayout {
            name,
            size: *span,
            members,
        })
    }

    /// A type's size in bytes; a run-time array counts as one element.
    pub fn size_of(&self, ty: Handle<Type>) -> u32 {
        // A module with a type too large for 32 bits is not valid.
        let size = self.module.types[ty].inner.try_size(self.module.to_ctx());
        size.unwrap_or(u32::MAX)
    }
}

fn other_name(ty: &Type) -> String {
    ty.name.clone().unwrap_or_else(|| match &ty.inner {
        TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Bool => "bool".to_owned(),
        TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Bool => {
            format!("vec{}<bool>", *size as u32)
        }
        TypeInner::BindingArray { .. } => "binding_array".to_owned(),
        TypeInner::AccelerationStructure { .. } => "acceleration_structure".to_owned(),
        TypeInner::Image { .. } => "texture_external".to_owned(),
        _ => "a type that buffers do not hold".to_owned(),
    })
}
