//! What a render graph asks of a checked module.

use naga::valid::FunctionInfo;
use naga::{
    AddressSpace, Expression, GlobalVariable, Handle, ImageClass, ImageDimension, Literal,
    ScalarKind, ShaderStage, StorageAccess, StorageFormat, TypeInner,
};
use volgraph_report::Place;

use crate::layout::{Layouts, Member, ScalarType, StructLayout, scalar_type};
use crate::{Module, ParamSpec};

/// An entry point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EntryPoint {
    /// Its function's name.
    pub name: String,
    /// Vertex, fragment or compute.
    pub stage: ShaderStage,
    /// Invocations per workgroup of a compute shader; zeros otherwise.
    pub workgroup_size: [u32; 3],
    /// Where its name stands.
    pub place: Place,
}

/// A resource that an entry point uses.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// The variable's name.
    pub name: String,
    /// `@group`
    pub group: u32,
    /// `@binding`
    pub binding: u32,
    /// What it binds.
    pub kind: BindingKind,
    /// Where it is declared.
    pub place: Place,
}

/// A texture's dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureDim {
    /// `texture_1d`
    D1,
    /// `texture_2d`
    D2,
    /// `texture_2d_array`
    D2Array,
    /// `texture_3d`
    D3,
    /// `texture_cube`
    Cube,
    /// `texture_cube_array`
    CubeArray,
}

/// What a texture gives when read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureSample {
    /// Floats.
    Float {
        /// Whether the entry point samples it with a sampler that filters; `false` where it only loads, or picks the
        /// nearest texel (see [`NEAREST_SAMPLER`]).
        filterable: bool,
    },
    /// Signed integers.
    Sint,
    /// Unsigned integers.
    Uint,
    /// Depth.
    Depth,
}

/// What a binding binds.
#[derive(Clone, Debug, PartialEq)]
pub enum BindingKind {
    /// `var<uniform>`
    Uniform(StructLayout),
    /// `var<storage, …>`
    StorageBuffer {
        /// `false` for `read_write`.
        read_only: bool,
        /// The smallest buffer that fits, in bytes (one element of a run-time array).
        min_size: u64,
        /// Where it is a struct.
        layout: Option<StructLayout>,
    },
    /// A texture to read.
    Texture {
        /// Its dimension.
        dim: TextureDim,
        /// What it gives.
        sample: TextureSample,
        /// Several samples per texel.
        multisampled: bool,
    },
    /// A texture to write, or to read and write, without a sampler.
    StorageTexture {
        /// Its dimension.
        dim: TextureDim,
        /// Its texel format.
        format: StorageFormat,
        /// Read, write or both.
        access: StorageAccess,
    },
    /// A sampler.
    Sampler {
        /// `sampler_comparison`
        comparison: bool,
    },
    /// What volgraph binds nowhere (binding arrays, acceleration structures); its WGSL type.
    Other(String),
}

/// A pipeline-overridable constant.
#[derive(Clone, Debug, PartialEq)]
pub struct OverrideSpec {
    /// Its name.
    pub name: String,
    /// The key that a pipeline sets it by: its `@id` as a number, else its name.
    pub key: String,
    /// Its type; `None` for `bool`.
    pub ty: Option<ScalarType>,
    /// Its default where that is a plain number (`true` is 1).
    pub default: Option<f64>,
    /// Its doc comment.
    pub doc: String,
    /// Where it is declared.
    pub place: Place,
}

impl Module {
    /// All entry points, in their order in the linked text.
    #[must_use]
    pub fn entry_points(&self) -> Vec<EntryPoint> {
        let mut points: Vec<EntryPoint> = self
            .naga
            .entry_points
            .iter()
            .map(|point| EntryPoint {
                name: point.name.clone(),
                stage: point.stage,
                workgroup_size: self.workgroup_size(point),
                place: self.place_of(&point.name),
            })
            .collect();
        // naga orders them by who refers to what.
        let order = |name: &str| {
            self.linked
                .declared
                .iter()
                .position(|declared| declared.name == name)
        };
        points.sort_by_key(|point| order(&point.name));
        points
    }

    /// The resources that `entry` really uses, itself or through the functions it calls, by group and binding.
    /// Empty for an unknown entry point.
    #[must_use]
    pub fn used_bindings(&self, entry: &str) -> Vec<Binding> {
        let Some(at) = self
            .naga
            .entry_points
            .iter()
            .position(|point| point.name == entry)
        else {
            return Vec::new();
        };
        let info = self.info.get_entry_point(at);
        let mut bindings: Vec<Binding> = self
            .naga
            .global_variables
            .iter()
            .filter(|(handle, _)| !info[*handle].is_empty())
            .filter_map(|(handle, variable)| {
                let resource = variable.binding?;
                let name = variable.name.clone().unwrap_or_default();
                Some(Binding {
                    kind: self.kind(variable, is_filtered(&self.naga, info, handle)),
                    place: self.place_of(&name),
                    name,
                    group: resource.group,
                    binding: resource.binding,
                })
            })
            .collect();
        bindings.sort_by_key(|binding| (binding.group, binding.binding));
        bindings
    }

    /// All overrides, in their order in the linked text.
    #[must_use]
    pub fn overrides(&self) -> Vec<OverrideSpec> {
        let mut overrides: Vec<OverrideSpec> = self
            .naga
            .overrides
            .iter()
            .filter_map(|(_, value)| {
                let name = value.name.clone()?;
                let declared = self.linked.declaration(&name);
                Some(OverrideSpec {
                    key: value.id.map_or_else(|| name.clone(), |id| id.to_string()),
                    ty: match self.naga.types[value.ty].inner {
                        TypeInner::Scalar(scalar) => scalar_type(scalar),
                        _ => None,
                    },
                    default: value.init.and_then(|init| self.number(init)),
                    doc: declared.map_or_else(String::new, |it| self.linked.doc(it.file, &it.docs)),
                    place: self.place_of(&name),
                    name,
                })
            })
            .collect();
        let order = |name: &str| {
            self.linked
                .declared
                .iter()
                .position(|declared| declared.name == name)
        };
        overrides.sort_by_key(|value| order(&value.name));
        overrides
    }

    /// The members of the merged `struct Params`, in their order.
    #[must_use]
    pub fn params(&self) -> &[ParamSpec] {
        &self.params
    }

    /// The layout of a struct, by its own name or by the name of a variable of that type.
    #[must_use]
    pub fn struct_layout(&self, name: &str) -> Option<StructLayout> {
        let types = &self.naga.types;
        let named = types
            .iter()
            .map(|(_, ty)| ty)
            .find(|ty| ty.name.as_deref() == Some(name));
        let mut variables = self
            .naga
            .global_variables
            .iter()
            .map(|(_, variable)| variable);
        let ty = named.or_else(|| {
            let variable = variables.find(|variable| variable.name.as_deref() == Some(name))?;
            Some(&types[variable.ty])
        })?;
        Layouts::new(&self.naga, &self.linked).struct_layout(ty)
    }

    fn kind(&self, variable: &GlobalVariable, is_filtered: bool) -> BindingKind {
        let ty = &self.naga.types[variable.ty];
        let mut layouts = Layouts::new(&self.naga, &self.linked);
        let layout = layouts.struct_layout(ty);
        let size = layouts.size_of(variable.ty);
        match (variable.space, &ty.inner) {
            (AddressSpace::Uniform, _) => BindingKind::Uniform(layout.unwrap_or_else(|| {
                let name = variable.name.clone().unwrap_or_default();
                let member = Member {
                    name: name.clone(),
                    offset: 0,
                    size,
                    ty: layouts.member_type(variable.ty),
                    place: self.place_of(&name),
                };
                StructLayout {
                    name,
                    size,
                    members: vec![member],
                }
            })),
            (AddressSpace::Storage { access }, _) => BindingKind::StorageBuffer {
                read_only: !access.contains(StorageAccess::STORE),
                min_size: size.into(),
                layout,
            },
            (_, TypeInner::Sampler { comparison }) => BindingKind::Sampler {
                comparison: *comparison,
            },
            (
                _,
                TypeInner::Image {
                    dim,
                    arrayed,
                    class,
                },
            ) => {
                let dim = match (dim, arrayed) {
                    (ImageDimension::D1, _) => TextureDim::D1,
                    (ImageDimension::D2, false) => TextureDim::D2,
                    (ImageDimension::D2, true) => TextureDim::D2Array,
                    (ImageDimension::D3, _) => TextureDim::D3,
                    (ImageDimension::Cube, false) => TextureDim::Cube,
                    (ImageDimension::Cube, true) => TextureDim::CubeArray,
                };
                let texture = |sample, multisampled| BindingKind::Texture {
                    dim,
                    sample,
                    multisampled,
                };
                match *class {
                    ImageClass::Sampled {
                        kind: ScalarKind::Sint,
                        multi,
                    } => texture(TextureSample::Sint, multi),
                    ImageClass::Sampled {
                        kind: ScalarKind::Uint,
                        multi,
                    } => texture(TextureSample::Uint, multi),
                    ImageClass::Sampled { multi, .. } => texture(
                        TextureSample::Float {
                            filterable: is_filtered,
                        },
                        multi,
                    ),
                    ImageClass::Depth { multi } => texture(TextureSample::Depth, multi),
                    ImageClass::Storage { format, access } => BindingKind::StorageTexture {
                        dim,
                        format,
                        access,
                    },
                    ImageClass::External => BindingKind::Other("texture_external".to_owned()),
                }
            }
            _ => BindingKind::Other(layouts.member_type(variable.ty).to_string()),
        }
    }

    fn place_of(&self, name: &str) -> Place {
        let place = self.linked.declaration_place(name);
        place.unwrap_or_else(|| self.linked.root_place())
    }

    /// The workgroup's size with all overrides at their defaults; 0 where one has none.
    fn workgroup_size(&self, point: &naga::EntryPoint) -> [u32; 3] {
        let mut size = point.workgroup_size;
        for (size, expression) in size
            .iter_mut()
            .zip(point.workgroup_size_overrides.unwrap_or_default())
        {
            if let Some(expression) = expression {
                let number = self.number(expression).filter(|number| *number >= 0.0);
                // Values above u32 saturate, and are refused by every device.
                *size = number.map_or(0, |number| number as u32);
            }
        }
        size
    }

    /// The value of a module-scope expression where it is a plain number or names one.
    fn number(&self, mut expression: Handle<Expression>) -> Option<f64> {
        // Each step goes to an earlier expression; the bound is for a module that is not valid.
        for _ in 0..self.naga.global_expressions.len() {
            match &self.naga.global_expressions[expression] {
                Expression::Literal(literal) => return Some(literal_number(*literal)),
                Expression::Constant(constant) => expression = self.naga.constants[*constant].init,
                Expression::Override(value) => expression = self.naga.overrides[*value].init?,
                Expression::ZeroValue(_) => return Some(0.0),
                _ => return None,
            }
        }
        None
    }
}

/// The sampler that picks the nearest texel, by its name: it needs no format that can be filtered.
pub const NEAREST_SAMPLER: &str = "nearest_sampler";

/// Whether a texture is used together with a sampler that filters, by this function or what it calls.
fn is_filtered(
    module: &naga::Module,
    info: &FunctionInfo,
    texture: Handle<GlobalVariable>,
) -> bool {
    let filters = |sampler: Handle<GlobalVariable>| {
        module.global_variables[sampler].name.as_deref() != Some(NEAREST_SAMPLER)
    };
    info.sampling_set
        .iter()
        .any(|pair| pair.image == texture && filters(pair.sampler))
}

fn literal_number(literal: Literal) -> f64 {
    match literal {
        Literal::F64(number) | Literal::AbstractFloat(number) => number,
        Literal::F32(number) => number.into(),
        Literal::F16(number) => number.into(),
        Literal::U16(number) => number.into(),
        Literal::I16(number) => number.into(),
        Literal::U32(number) => number.into(),
        Literal::I32(number) => number.into(),
        Literal::U64(number) => number as f64,
        Literal::I64(number) | Literal::AbstractInt(number) => number as f64,
        Literal::Bool(is) => f64::from(u8::from(is)),
    }
}
