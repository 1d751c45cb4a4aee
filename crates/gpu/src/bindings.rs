//! From reflected bindings to bind group layouts, and formats between naga and wgpu.

use naga::{StorageAccess, StorageFormat};
use volgraph_report::Finding;
use volgraph_shader::{Binding, BindingKind, TextureDim, TextureSample};
use wgpu::{
    BindGroupLayoutEntry, BindingType, BufferBindingType, SamplerBindingType, ShaderStages,
    StorageTextureAccess, TextureFormat, TextureSampleType, TextureViewDimension,
};

/// The layout entry of a binding; `uniforms_as_storage` as in [`with_uniforms_as_storage`].
pub(crate) fn layout_entry(
    binding: &Binding,
    visibility: ShaderStages,
    uniforms_as_storage: bool,
) -> Result<BindGroupLayoutEntry, Finding> {
    let unsupported = |what: String| {
        Finding::error(
            "unsupported-binding",
            format!("binding `{}`: {what}", binding.name),
        )
        .at(binding.place.clone())
    };
    let ty = match &binding.kind {
        BindingKind::Uniform(_) if uniforms_as_storage => {
            buffer(BufferBindingType::Storage { read_only: true })
        }
        BindingKind::Uniform(_) => buffer(BufferBindingType::Uniform),
        BindingKind::StorageBuffer { read_only, .. } => buffer(BufferBindingType::Storage {
            read_only: *read_only,
        }),
        BindingKind::Texture {
            dim,
            sample,
            multisampled,
        } => BindingType::Texture {
            sample_type: match sample {
                TextureSample::Float { filterable } => TextureSampleType::Float {
                    filterable: *filterable,
                },
                TextureSample::Sint => TextureSampleType::Sint,
                TextureSample::Uint => TextureSampleType::Uint,
                TextureSample::Depth => TextureSampleType::Depth,
            },
            view_dimension: dimension(*dim),
            multisampled: *multisampled,
        },
        BindingKind::StorageTexture {
            dim,
            format,
            access,
        } => BindingType::StorageTexture {
            access: match *access {
                access if access == StorageAccess::STORE => StorageTextureAccess::WriteOnly,
                access if access == StorageAccess::LOAD => StorageTextureAccess::ReadOnly,
                _ => StorageTextureAccess::ReadWrite,
            },
            format: texture_format(*format).ok_or_else(|| {
                unsupported(format!("storage format {format:?} is not supported"))
            })?,
            view_dimension: dimension(*dim),
        },
        BindingKind::Sampler { comparison } => BindingType::Sampler(if *comparison {
            SamplerBindingType::Comparison
        } else if binding.name == volgraph_shader::NEAREST_SAMPLER {
            SamplerBindingType::NonFiltering
        } else {
            SamplerBindingType::Filtering
        }),
        BindingKind::Other(ty) => return Err(unsupported(format!("type {ty} is not supported"))),
    };
    Ok(BindGroupLayoutEntry {
        binding: binding.binding,
        visibility,
        ty,
        count: None,
    })
}

fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

fn dimension(dim: TextureDim) -> TextureViewDimension {
    match dim {
        TextureDim::D1 => TextureViewDimension::D1,
        TextureDim::D2 => TextureViewDimension::D2,
        TextureDim::D2Array => TextureViewDimension::D2Array,
        TextureDim::D3 => TextureViewDimension::D3,
        TextureDim::Cube => TextureViewDimension::Cube,
        TextureDim::CubeArray => TextureViewDimension::CubeArray,
    }
}

/// The module with every uniform read as a storage buffer instead; the layout of uniforms holds there as well.
///
/// For lavapipe: it compiles values of uniforms into compute shaders anew, and up to Mesa 22.3 that crashes the whole
/// process for some conditions that depend on uniforms. It leaves storage buffers alone.
pub(crate) fn with_uniforms_as_storage(mut module: naga::Module) -> naga::Module {
    for (_, variable) in module.global_variables.iter_mut() {
        if variable.space == naga::AddressSpace::Uniform {
            variable.space = naga::AddressSpace::Storage {
                access: StorageAccess::LOAD,
            };
        }
    }
    module
}

/// The wgpu format of a storage texture; `None` for one that no node kind can write.
pub(crate) fn texture_format(format: StorageFormat) -> Option<TextureFormat> {
    use StorageFormat as S;
    use TextureFormat as T;
    Some(match format {
        S::R32Float => T::R32Float,
        S::R32Uint => T::R32Uint,
        S::R32Sint => T::R32Sint,
        S::Rg32Float => T::Rg32Float,
        S::Rgba8Unorm => T::Rgba8Unorm,
        S::Rgba8Snorm => T::Rgba8Snorm,
        S::Rgba8Uint => T::Rgba8Uint,
        S::Rgba16Float => T::Rgba16Float,
        S::Rgba32Float => T::Rgba32Float,
        S::Rgba32Uint => T::Rgba32Uint,
        S::R8Unorm => T::R8Unorm,
        S::R16Float => T::R16Float,
        S::Rg16Float => T::Rg16Float,
        S::R16Unorm => T::R16Unorm,
        _ => return None,
    })
}
