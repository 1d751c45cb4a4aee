//! `gradient`: a volume of gradients, made once and looked up by lit techniques.
//!
//! A compute shader makes it. Where the device cannot write 3D textures, the processor does the same work; that
//! twin knows volgraph's own methods and storages alone.

mod on_cpu;

use naga::StorageFormat;
use volgraph_graph::{
    Demand, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, Requirement,
    ResourceDesc, Size, SlotSpec, Uniform,
};
use volgraph_report::Finding;
use volgraph_shader::{BindingKind, ParamSpec};
use wgpu_types::TextureFormat;

use crate::placement;
use crate::volume_texture::storage_param;

/// The node kind `gradient`.
pub struct Gradient;

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume.",
    },
    InputPort {
        name: "volume_texture",
        ty: PortType::VolumeTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "volume_texture",
            inputs: &[("volume", "volume")],
            params: &[("volume_storage", "volume_storage")],
            slots: &[],
        }),
        doc: "The volume on the device.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "gradient",
    ty: PortType::GradientTexture,
    doc: "Gradients per voxel along the index axes, as a share of the data's range.",
}];

const SLOTS: &[SlotSpec] = &[
    SlotSpec {
        name: "gradient_method",
        default: "central",
        doc: "What is the gradient at a voxel?",
    },
    SlotSpec {
        name: "gradient_storage",
        default: "rgba16f",
        doc: "How are gradients stored?",
    },
];

impl NodeKind for Gradient {
    fn name(&self) -> &'static str {
        "gradient"
    }

    fn doc(&self) -> &'static str {
        "Makes a volume of gradients, by central differences or the Sobel operator."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![storage_param()]
    }

    fn slots(&self) -> &[SlotSpec] {
        SLOTS
    }

    fn uniforms(&self) -> &[&'static str] {
        &["volume"]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        node.limits().storage_3d.then(|| ProgramSpec {
            root: "node/gradient.wgsl",
            fixed_slots: placement::texel_slots(node).into(),
            entries: vec!["gradient_compute"],
            inherited: Vec::new(),
        })
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let format = match node.binding("gradient_out").map(|binding| &binding.kind) {
            None if !node.limits().storage_3d => on_cpu::Storage::named(node)?.format(),
            Some(BindingKind::StorageTexture {
                format: StorageFormat::Rgba8Snorm,
                ..
            }) => TextureFormat::Rgba8Snorm,
            Some(BindingKind::StorageTexture {
                format: StorageFormat::Rgba16Float,
                ..
            }) => TextureFormat::Rgba16Float,
            Some(BindingKind::StorageTexture {
                format: StorageFormat::Rgba32Float,
                ..
            }) => TextureFormat::Rgba32Float,
            _ => {
                return Err(node
                    .error("bad-storage", "its slot `gradient_storage` declares no texture `gradient_out` that can be filtered")
                    .help("declare `gradient_out: texture_storage_3d<rgba16float, write>`, `<rgba32float, write>` or `<rgba8snorm, write>`"));
            }
        };
        if format == TextureFormat::Rgba32Float && !node.limits().float32_filterable {
            let message =
                "its slot `gradient_storage` stores single floats, which this device cannot filter";
            return Err(node
                .error("unsupported-slot", message)
                .help("choose the slot `gradient_storage` \"rgba16f\", or another adapter"));
        }
        let dims = placement::volume(node, "volume")?.grid().dims;
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute(dims),
            format,
        })
    }

    fn uniform(&self, _name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        placement::uniform(node)
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        if !node.limits().storage_3d {
            return on_cpu::record(node);
        }
        let [x, y, z] = placement::volume(node, "volume")?.grid().dims;
        Ok(vec![Pass::Compute {
            entry: "gradient_compute",
            workgroups: [x.div_ceil(8), y.div_ceil(8), z],
            constants: Vec::new(),
        }])
    }
}
